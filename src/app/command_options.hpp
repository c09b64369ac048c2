// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
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

/// The check that the value of an option is a number of a range; no range has NaN. `unit` is named
/// in messages, such as "in degrees".
std::function<std::string(const std::string&)> number_in(const NumberRange& range,
                                                         const std::string& unit = "");

/// The check that the value of an option names something: an empty name would be taken for none.
std::string not_empty(const std::string& text);

/// The integers that an option takes; without an end, all that fit its type.
struct IntegerBounds {
  std::uint64_t lowest = 0;
  std::uint64_t highest = std::numeric_limits<std::uint64_t>::max();
};

/// What the value of an integer option goes through: it is decimal digits and nothing else. CLI11
/// alone reads 010 as 8, and what does not fit as the largest number that does.
CLI::Validator integer_in(const IntegerBounds& bounds);

/// The type of one value of an option.
template <class Target>
struct ValueOf {
  using Type = Target;
};
template <class Target>
requires requires { typename Target::value_type; }
struct ValueOf<Target> {
  using Type = typename Target::value_type;
};

/// Adds an option whose values are integers, which all such options are added by. `target` is an
/// integer, an optional of one, or a vector of them.
template <class Target>
CLI::Option* add_integer_option(CLI::App& command, const std::string& name, Target& target,
                                IntegerBounds bounds, const std::string& help) {
  using Integer = typename ValueOf<Target>::Type;
  static_assert(std::is_integral_v<Integer>);
  constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<Integer>::max());
  bounds.highest = std::min(bounds.highest, kLargest);
  return command.add_option(name, target, help)->transform(integer_in(bounds))->type_name("N");
}

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
