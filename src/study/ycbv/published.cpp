// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "published.hpp"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

constexpr std::string_view kPublishedPrefix = "published: ";

/// The head of the table: object, seq, one column for each method [px], and shares in per cent.
std::vector<std::string_view> read_head(LineReader& reader) {
  if (!reader.next_content()) reader.fail("no line", "a line with the names of the columns");
  std::vector<std::string_view> head = split_fields(reader.line(), ',');
  if (head.size() < 3 || head[0] != "object" || head[1] != "seq")
    reader.fail(in_quotes(reader.line()), "columns object, seq and those of the methods");
  return head;
}

}  // namespace

bool is_published_offline(std::string_view method) { return method.starts_with(kPublishedPrefix); }

std::vector<PublishedPixels> published_pixels(const Recording& recording) {
  const auto path = recording.data / "derived" / "slam6d_published_table1.csv";
  std::error_code ignored;
  if (recording.detector != "dope" || !std::filesystem::exists(path, ignored)) return {};
  const std::string text = read_file(path);
  LineReader reader(text, path.string());
  const auto head = read_head(reader);
  while (reader.next_content()) {
    const auto fields = split_fields(reader.line(), ',');
    if (fields.size() != head.size()) {
      reader.fail(fmt::format("{} fields", fields.size()),
                  fmt::format("{} as in the first line", head.size()));
    }
    if (fields[0] != recording.object || fields[1] != recording.sequence) continue;
    std::vector<PublishedPixels> pixels;
    for (std::size_t i = 2; i < head.size(); ++i) {
      if (head[i].starts_with('%')) continue;
      pixels.push_back({std::string(kPublishedPrefix) + std::string(head[i]),
                        reader.number_from(fields[i], head[i])});
    }
    return pixels;
  }
  return {};
}

}  // namespace posemix
