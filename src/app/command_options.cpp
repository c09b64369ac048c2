// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "command_options.hpp"

#include <charconv>
#include <system_error>

#include "posemix/io/text.hpp"

namespace posemix {

void add_out_option(CLI::App& command, OutputOptions& output) {
  command.add_option("--out", output.out, "File for the result; - is the standard output")
      ->type_name("FILE")
      ->capture_default_str();
  command.add_flag("--quiet", output.quiet, "Write nothing but the result");
}

void add_report_options(CLI::App& command, OutputOptions& output) {
  add_out_option(command, output);
  CLI::Option* json =
      command.add_flag("--json", output.json, "Report on the standard error as one line of JSON");
  command.get_option("--quiet")->excludes(json);
}

void add_seed_option(CLI::App& command, std::uint64_t& seed) {
  add_integer_option(command, "--seed", seed, {}, "Seed of all random numbers")
      ->capture_default_str();
}

std::function<std::string(const std::string&)> number_in(const NumberRange& range,
                                                         const std::string& unit) {
  return [range, unit](const std::string& text) {
    double number = 0.0;
    // CLI11 takes an empty word for zero.
    const bool is_number = !text.empty() && CLI::detail::lexical_cast(text, number);
    if (is_number && range.contains(number)) return std::string();
    return fmt::format("got {}, expected a {}{}{}", text.empty() ? "''" : text, range.describe(),
                       unit.empty() ? "" : ", ", unit);
  };
}

std::string not_empty(const std::string& text) {
  return text.empty() ? "got an empty name, expected one" : "";
}

CLI::Validator integer_in(const IntegerBounds& bounds) {
  const auto read = [bounds](std::string& text) {
    std::uint64_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    const bool is_number = error == std::errc() && rest == end;
    if (!is_number || number < bounds.lowest || number > bounds.highest) {
      return fmt::format("got {}, expected an integer from {} to {} in decimal digits",
                         in_quotes(text), bounds.lowest, bounds.highest);
    }
    text = std::to_string(number);  // without zeros before it, which CLI11 takes for octal
    return std::string();
  };
  // Ends that are those of the type itself say nothing in a help text.
  constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  const bool has_end = bounds.highest < kLargest;
  return {read, has_end ? fmt::format("INT in [{} - {}]", bounds.lowest, bounds.highest) : ""};
}

CLI::Option* add_count_option(CLI::App& command, const std::string& name, std::size_t& count,
                              const std::string& help) {
  return add_integer_option(command, name, count, {1, 1'000'000'000}, help);
}

}  // namespace posemix
