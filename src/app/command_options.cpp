// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "command_options.hpp"

namespace posemix {
namespace {

std::string not_negative(const std::string& number) {
  return number.starts_with('-') ? "got " + number + ", expected an integer of at least 0" : "";
}

}  // namespace

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
  command.add_option("--seed", seed, "Seed of all random numbers")
      ->check(not_negative)
      ->type_name("N")
      ->capture_default_str();
}

std::function<std::string(const std::string&)> number_in(const NumberRange& range) {
  return [range](const std::string& text) {
    double number = 0.0;
    const bool is_number = CLI::detail::lexical_cast(text, number);
    if (is_number && range.contains(number)) return std::string();
    return fmt::format("got {}, expected a {}", text, range.describe());
  };
}

CLI::Option* add_count_option(CLI::App& command, const std::string& name, std::size_t& count,
                              const std::string& help) {
  return command.add_option(name, count, help)
      ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000'000}))
      ->type_name("N");
}

}  // namespace posemix
