// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/range.hpp"

#include <cmath>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {

bool NumberRange::contains(double number) const {
  if (with_infinity && number == std::numeric_limits<double>::infinity()) return true;
  const bool above = without_lowest ? number > lowest : number >= lowest;
  const bool below = without_highest ? number < highest : number <= highest;
  return above && below && std::isfinite(number);
}

std::string NumberRange::describe() const {
  const bool no_highest = std::isinf(highest);
  if (std::isinf(lowest) && no_highest) return "finite number";
  if (lowest == 0 && no_highest)
    return without_lowest ? "positive number" : "number that is not negative";
  return fmt::format("number in {}{}, {}{}", without_lowest || std::isinf(lowest) ? '(' : '[',
                     lowest, highest, without_highest || no_highest ? ')' : ']');
}

void NumberRange::check(double number, const std::string& name) const {
  if (contains(number)) return;
  throw InvalidInput(fmt::format("{} is {}, expected a {}", name, number, describe()));
}

std::string IntegerRange::describe() const {
  const bool no_lowest = lowest == std::numeric_limits<std::int64_t>::min();
  const bool no_highest = highest == std::numeric_limits<std::int64_t>::max();
  if (no_lowest && no_highest) return "integer";
  if (no_highest) return fmt::format("integer of at least {}", lowest);
  if (no_lowest) return fmt::format("integer of at most {}", highest);
  return fmt::format("integer in [{}, {}]", lowest, highest);
}

void internal::check_count(std::size_t count, std::string_view name) {
  if (count > kLargestCount)
    throw InvalidInput(fmt::format("{} is {}, expected at most {}", name, count, kLargestCount));
}

void internal::refuse_index(std::size_t index, std::size_t count, std::string_view what) {
  throw InvalidInput(fmt::format("there is no {} {}; there are {}", what, index, count));
}

}  // namespace posemix
