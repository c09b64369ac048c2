// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "posemix/base/range.hpp"
#include "posemix/base/words.hpp"

/// Options that several commands share.
namespace posemix {

/// The output of a command, and its report on the standard error.
struct OutputOptions {
  std::string out = "-";
  bool json = false;
  bool quiet = false;
};

/// Adds --out and --quiet.
void add_out_option(CLI::App& command, OutputOptions& output);
/// Adds --out, --json and --quiet, for commands that report on the standard error.
void add_report_options(CLI::App& command, OutputOptions& output);

void add_seed_option(CLI::App& command, std::uint64_t& seed);

/// The check that the value of an option is a number of a range; no range has NaN.
std::function<std::string(const std::string&)> number_in(const NumberRange& range);

/// Adds an option whose value is an integer of at least one.
CLI::Option* add_count_option(CLI::App& command, const std::string& name, std::size_t& count,
                              const std::string& help);

/// Adds an option whose value is one of some words. `target` is an Enum or an optional of one.
template <class Target, class Enum>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Target& target,
                        const std::vector<std::pair<std::string, Enum>>& words,
                        const std::string& help) {
  std::string all;
  for (const auto& [word, value] : words) all += (all.empty() ? "" : "|") + word;
  const auto choose = [&target, words, all, name](const std::string& got) {
    for (const auto& [word, value] : words) {
      if (got == word) {
        target = value;
        return;
      }
    }
    throw CLI::ValidationError(name, fmt::format("got {}, expected {}", got, all));
  };
  return command.add_option_function<std::string>(name, choose, help)->type_name(all);
}

/// Adds an option whose value is one of the words of an enum.
template <Spelled Enum, class Target>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Target& target,
                        const std::string& help) {
  return add_choice<Target, Enum>(command, name, target, {words<Enum>.begin(), words<Enum>.end()},
                                  help);
}

}  // namespace posemix
