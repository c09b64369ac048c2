// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <system_error>
#include <tuple>

#include <fmt/format.h>

#include "compression.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "report_parts.hpp"

namespace posemix::internal {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kJpeg("\xff\xd8\xff", 3);
constexpr std::string_view kPng("\x89PNG\r\n\x1a\n", 8);

struct StampedImage {
  double stamp_s;
  fs::path path;
  std::size_t bytes;
};

bool is_image_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png";
}

/// The longest number in a name, as a stamp in seconds.
std::optional<double> stamp_in(const std::string& name) {
  constexpr std::size_t kNanosecondDigits = 16;
  constexpr std::string_view kDigits = "0123456789";
  std::string_view best;
  const std::string_view text(name);
  for (std::size_t at = text.find_first_of(kDigits); at != std::string_view::npos;) {
    std::size_t end = std::min(text.find_first_not_of(kDigits, at), text.size());
    const bool has_point = end + 1 < text.size() && text[end] == '.' &&
                           kDigits.find(text[end + 1]) != std::string_view::npos;
    if (has_point) end = std::min(text.find_first_not_of(kDigits, end + 1), text.size());
    if (end - at > best.size()) best = text.substr(at, end - at);
    at = text.find_first_of(kDigits, end);
  }
  const std::optional<double> number = parse_number(best);
  if (!number) return std::nullopt;
  const bool nanoseconds =
      best.find('.') == std::string_view::npos && best.size() >= kNanosecondDigits;
  return nanoseconds ? 1e-9 * *number : *number;
}

/// The stamps of stamps.csv by name, where there is one.
std::optional<std::map<std::string, double>> stamps_of(const fs::path& folder) {
  const fs::path path = folder / "stamps.csv";
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  const std::string text = read_file(path);
  LineReader lines(text, path.string());
  std::map<std::string, double> stamps;
  if (!lines.next_content() || trimmed(lines.line()) != "name,stamp_s")
    lines.fail(in_quotes(lines.line(), 80), "the columns name,stamp_s");
  while (lines.next_content()) {
    const std::string_view line = lines.line();
    const std::size_t comma = line.rfind(',');
    const auto stamp = comma == std::string_view::npos
                           ? std::nullopt
                           : parse_number(trimmed(line.substr(comma + 1)));
    if (!stamp) lines.fail(in_quotes(line, 80), "a name, a comma and a stamp in seconds");
    stamps[std::string(trimmed(line.substr(0, comma)))] = *stamp;
  }
  return stamps;
}

std::vector<StampedImage> images_in(const fs::path& folder) {
  const auto stamps = stamps_of(folder);
  std::vector<StampedImage> images;
  std::error_code error;
  fs::directory_iterator at(folder, error);
  for (; !error && at != fs::directory_iterator(); at.increment(error)) {
    const fs::path& path = at->path();
    std::error_code of_file;
    if (!is_image_name(path) || fs::is_directory(path, of_file)) continue;
    const std::string name = path.filename().string();
    std::optional<double> stamp;
    if (!stamps) {
      stamp = stamp_in(path.stem().string());
    } else if (const auto found = stamps->find(name); found != stamps->end()) {
      stamp = found->second;
    }
    if (!stamp) {
      throw InvalidInput(fmt::format("{}: got no stamp, expected {}", path.string(),
                                     stamps ? "one in stamps.csv"
                                            : "a number in the name, or a file stamps.csv with "
                                              "the columns name,stamp_s"));
    }
    const std::uintmax_t bytes = fs::file_size(path, of_file);
    if (of_file)
      throw InvalidInput(fmt::format("{}: cannot be read: {}", path.string(), of_file.message()));
    images.push_back({*stamp, path, static_cast<std::size_t>(bytes)});
  }
  if (error) {
    throw InvalidInput(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
  }
  std::sort(images.begin(), images.end(), [](const StampedImage& a, const StampedImage& b) {
    return std::tie(a.stamp_s, a.path) < std::tie(b.stamp_s, b.path);
  });
  return images;
}

/// The least n such that every n-th image has few enough bytes in all.
std::size_t step_of(const std::vector<StampedImage>& images, std::size_t most_bytes) {
  for (std::size_t step = 1; step < images.size(); ++step) {
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < images.size(); i += step) bytes += images[i].bytes;
    if (bytes <= most_bytes) return step;
  }
  return std::max<std::size_t>(images.size(), 1);
}

Json image_json(const StampedImage& image) {
  const std::string bytes = read_file(image.path);
  const bool jpeg = bytes.starts_with(kJpeg);
  if (!jpeg && !bytes.starts_with(kPng)) {
    throw InvalidInput(
        fmt::format("{}: got another content, expected JPEG or PNG", image.path.string()));
  }
  return {{"stamp_s", image.stamp_s},
          {"type", jpeg ? "image/jpeg" : "image/png"},
          {"data", base64(bytes)}};
}

}  // namespace

Json images_json(const ReportOptions& options) {
  const std::vector<StampedImage> images = images_in(options.images->folder);
  if (images.empty()) {
    throw InvalidInput(fmt::format("{}: got no image, expected JPEG or PNG files",
                                   options.images->folder.string()));
  }
  const std::size_t step = step_of(images, options.images->most_bytes);
  Json list = Json::array();
  for (std::size_t i = 0; i < images.size(); i += step) list.push_back(image_json(images[i]));
  if (step > 1) {
    warn({fmt::format("{}: the page has {} of {} images, one in {}, as more than {:.1f} MB of them "
                      "would make it too large",
                      options.images->folder.string(), list.size(), images.size(), step,
                      1e-6 * static_cast<double>(options.images->most_bytes))},
         options);
  }
  return list;
}

}  // namespace posemix::internal
