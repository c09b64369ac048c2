// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/corner_file.hpp"

#include <fmt/format.h>

#include "io/csv_table.hpp"
#include "io/observation_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/text.hpp"

namespace posemix {

std::vector<CornerSighting> parse_corners(std::string_view text, const std::string& name) {
  internal::CsvTable table(text, name);
  std::array<std::array<std::string, 2>, 4> pixels;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = {fmt::format("u{}_px", i), fmt::format("v{}_px", i)};
  for (const char* column : {"stamp_s", "topic", "tag"}) table.require_column(column);
  for (const auto& columns : pixels) {
    for (const std::string& column : columns) table.require_column(column);
  }
  std::vector<CornerSighting> sightings;
  while (table.next()) {
    CornerSighting row;
    row.stamp_s = table.number("stamp_s");
    if (const auto wrong = internal::wrong_stamp(row.stamp_s); !wrong.empty())
      table.reader().fail(fmt::format("stamp_s = {}", in_quotes(table.field("stamp_s"))), wrong);
    row.topic = table.field("topic");
    row.place = fmt::format("{}:{}", name, table.reader().number());
    row.tag = table.index("tag");
    for (std::size_t i = 0; i < pixels.size(); ++i)
      row.corners[i] = {table.number(pixels[i][0]), table.number(pixels[i][1])};
    sightings.push_back(std::move(row));
  }
  if (sightings.empty())
    throw InvalidInput(fmt::format("{}: got no rows, expected at least one", name));
  return sightings;
}

std::vector<CornerSighting> read_corners(const std::filesystem::path& path) {
  return parse_corners(read_file_or_gzip(path), path.string());
}

}  // namespace posemix
