// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "command_files.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>

#include "base/uninterrupted.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/text.hpp"
#include "summary.hpp"
#include "terminal_text.hpp"
#include "usage_error.hpp"

namespace posemix {
namespace {

constexpr std::string_view kStandardStream = "-";
constexpr std::size_t kLargestInput = std::size_t{1} << 30;

std::string read_standard_input() {
  std::string bytes;
  std::array<char, 65536> buffer;
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), stdin)) {
    bytes.append(buffer.data(), got);
    if (bytes.size() > kLargestInput) {
      throw InvalidInput("standard input: got more than 1 GiB, expected less");
    }
  }
  if (std::ferror(stdin) != 0) {
    internal::throw_if_interrupted(errno, "standard input");
    throw InvalidInput("standard input: cannot be read");
  }
  return bytes;
}

/// The standard error beside a number of an object: that of "value" is "standard_error", that of
/// "kl_nats" is "kl_standard_error".
std::optional<double> standard_error_of(const Json& found, const std::string& key) {
  const std::string kind = "standard_error";
  std::string name = key == "value" ? kind : key.substr(0, key.rfind('_') + 1) + kind;
  if (key.ends_with(kind)) name = key;
  const auto error = found.find(name);
  if (error == found.end() || !error->is_number()) return std::nullopt;
  return error->get<double>();
}

/// A number with the digits that its standard error leaves: two of the error.
std::string number_text(double number, const std::optional<double>& error) {
  if (!std::isfinite(number)) return "none";  // as null
  if (!error || !(*error > 0.0) || !std::isfinite(*error)) return fmt::format("{:.6g}", number);
  const int digit = static_cast<int>(std::floor(std::log10(*error))) - 1;
  const double unit = std::pow(10.0, digit);
  const bool is_plain = digit > -7 && std::abs(number) < 1e9;
  if (is_plain)
    return fmt::format("{:.{}f}", unit * std::round(number / unit), std::max(0, -digit));
  const double size = std::max(std::abs(number), *error);
  return fmt::format("{:.{}e}", number, static_cast<int>(std::floor(std::log10(size))) - digit);
}

std::string value_text(const Json& found, const std::string& key, const Json& value) {
  if (value.is_number_float())
    return number_text(value.get<double>(), standard_error_of(found, key));
  if (value.is_null()) return "none";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void add_rows(std::string& text, const Json& found, std::size_t indent) {
  std::size_t width = 0;
  for (const auto& [key, value] : found.items()) {
    if (!value.is_object()) width = std::max(width, key.size());
  }
  for (const auto& [key, value] : found.items()) {
    if (value.is_object()) {
      text += fmt::format("{:{}}{}:\n", "", indent, key);
      add_rows(text, value, indent + 2);
    } else {
      text += fmt::format("{:{}}{:<{}}  {}\n", "", indent, key + ":", width + 1,
                          value_text(found, key, value));
    }
  }
}

}  // namespace

std::string read_text_input(const std::string& path) {
  return path == kStandardStream ? read_standard_input() : read_file(path);
}

std::string input_name(const std::string& path) {
  return path == kStandardStream ? "standard input" : path;
}

void require_one_standard_input(std::span<const std::string> paths) {
  if (std::count(paths.begin(), paths.end(), kStandardStream) > 1) {
    throw UsageError("got '-' more than once, expected one input from the standard input");
  }
}

NamedMixture read_mixture_input(const std::string& path) {
  const std::string name = input_name(path);
  NamedMixture mixture{name, parse_mixture(read_text_input(path), name)};
  print_warnings(mixture.file.warnings);
  return mixture;
}

std::vector<NamedMixture> read_mixtures(std::span<const std::string> paths) {
  require_one_standard_input(paths);
  std::vector<NamedMixture> mixtures;
  for (const std::string& path : paths) mixtures.push_back(read_mixture_input(path));
  return mixtures;
}

PoseSamples read_pose_input(const std::string& path, const std::optional<PoseFormat>& format,
                            const PoseSampleOptions& options) {
  const auto known = format ? format : pose_format_of(path);
  if (!known) {
    throw InvalidInput(fmt::format(
        "{}: got a name that does not say the format, expected .csv, .tum, .txt, .npy, or --format",
        input_name(path)));
  }
  return parse_pose_samples(read_text_input(path), input_name(path), *known, options);
}

void write_output(const std::string& path, std::string_view content) {
  if (path == kStandardStream) {
    print_text(content);
  } else {
    write_output_file(path, content);
  }
}

std::string formatted(const MixtureFile& file, const MixtureConvention& convention,
                      std::string_view name) {
  try {
    return format_mixture(file, convention);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, error.what()));
  }
}

void write_mixture(const MixtureFile& file, const OutputOptions& output) {
  write_output(output.out, formatted(file, {}, "the result"));
}

std::string format_table(const Json& found) {
  std::string text;
  add_rows(text, found, 0);
  return text;
}

void report(std::string_view command, const Json& found, const OutputOptions& output) {
  if (output.quiet) return;
  std::string text = found.dump() + "\n";
  if (!output.json) {
    text = fmt::format("posemix {}:\n", command);
    add_rows(text, found, 2);
  }
  std::fputs(terminal_text(text).c_str(), stderr);
}

std::string transform_name(const FrameNames& frames) {
  return fmt::format("T_{}_{}", frames.from, frames.to);
}

void require_same_frames(const NamedMixture& a, const NamedMixture& b) {
  if (a.file.frames == b.file.frames) return;
  throw InvalidInput(fmt::format("{}: got {}, expected {} as in {}", b.name,
                                 transform_name(b.file.frames), transform_name(a.file.frames),
                                 a.name));
}

Distribution distribution_of(const AnyMixture& mixture) {
  return std::holds_alternative<ConcentratedPoses>(mixture) ? Distribution::concentrated
                                                            : Distribution::projected;
}

std::string_view distribution_name(const AnyMixture& mixture) {
  return word_of(distribution_of(mixture));
}

void add_format_option(CLI::App& command, std::optional<PoseFormat>& format) {
  add_choice<PoseFormat>(command, "--format", format,
                         "Format of the poses; without it what the end of the name says");
}

}  // namespace posemix
