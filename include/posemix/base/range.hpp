// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace posemix {

/// The interval that a number must lie in.
struct NumberRange {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool without_lowest = false;   ///< the lower end itself is not allowed
  bool without_highest = false;  ///< the upper end itself is not allowed
  bool with_infinity = false;    ///< plus infinity is allowed

  bool contains(double number) const;
  /// The kind of number for a message: "number", "positive number", "number in [0, 1]", ...
  std::string describe() const;
  /// @throws InvalidInput when the number lies outside, such as "name is 2, expected a number in
  /// [0, 1]"
  void check(double number, const std::string& name) const;
};

inline constexpr NumberRange kAnyNumber{};
inline constexpr NumberRange kPositive{.lowest = 0, .without_lowest = true};
inline constexpr NumberRange kNotNegative{.lowest = 0};
inline constexpr NumberRange kUnitInterval{.lowest = 0, .highest = 1};
inline constexpr NumberRange kOpenUnitInterval{
    .lowest = 0, .highest = 1, .without_lowest = true, .without_highest = true};

/// The interval that an integer must lie in.
struct IntegerRange {
  std::int64_t lowest = std::numeric_limits<std::int64_t>::min();
  std::int64_t highest = std::numeric_limits<std::int64_t>::max();

  bool contains(std::int64_t number) const { return number >= lowest && number <= highest; }
  /// The kind of number for a message: "integer", "integer of at least 1", "integer in [0, 9]", ...
  std::string describe() const;
};

inline constexpr IntegerRange kAnyInteger{};
inline constexpr IntegerRange kAtLeastOne{.lowest = 1};
inline constexpr IntegerRange kAtLeastZero{.lowest = 0};

namespace internal {

/// The most that one call can be asked for: more is no number of anything, and products with it
/// would overflow.
inline constexpr std::size_t kLargestCount = 1'000'000'000'000;

/// @throws InvalidInput where `count` is beyond kLargestCount; `name` begins the message
void check_count(std::size_t count, std::string_view name);

/// @throws InvalidInput, such as "there is no object 3; there are 2"
[[noreturn]] void refuse_index(std::size_t index, std::size_t count, std::string_view what);

/// @throws InvalidInput where `count` things have none at `index`; `what` they are
inline void check_index(std::size_t index, std::size_t count, std::string_view what) {
  if (index >= count) refuse_index(index, count, what);
}

}  // namespace internal

}  // namespace posemix
