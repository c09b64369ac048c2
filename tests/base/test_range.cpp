// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/range.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "posemix/base/draw_index.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/stopwatch.hpp"
#include "posemix/base/words.hpp"

namespace posemix {

enum class Colour { red, light_blue };
template <>
inline constexpr WordTable<Colour, 2> words<Colour>{
    {{"red", Colour::red}, {"light_blue", Colour::light_blue}}};

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(NumberRange, EndsAndInfinity) {
  const NumberRange open_below{.lowest = 0, .highest = 1, .without_lowest = true};
  EXPECT_FALSE(open_below.contains(0.0));
  EXPECT_TRUE(open_below.contains(1.0));
  EXPECT_FALSE(kNotNegative.contains(kInfinity));
  EXPECT_FALSE(kAnyNumber.contains(std::numeric_limits<double>::quiet_NaN()));
  const NumberRange with_infinity{.lowest = 1, .with_infinity = true};
  EXPECT_TRUE(with_infinity.contains(kInfinity));
  EXPECT_FALSE(with_infinity.contains(-kInfinity));
}

TEST(NumberRange, CheckNamesValueAndExpectation) {
  EXPECT_NO_THROW(kUnitInterval.check(0.5, "part"));
  try {
    kOpenUnitInterval.check(1.0, "part");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "part is 1, expected a number in (0, 1)");
  }
}

TEST(Words, EveryValueHasItsWord) {
  static_assert(Spelled<Colour> && !Spelled<std::byte>);
  EXPECT_EQ(word_of(Colour::red), "red");
  EXPECT_EQ(word_of(Colour::light_blue), "light_blue");
}

TEST(IndexAtSum, IsTheFirstWhoseSumExceedsTheTarget) {
  const double weights[] = {0.0, 0.5, 0.0, 0.5};
  const auto weight = [&](std::size_t i) { return weights[i]; };
  EXPECT_EQ(index_at_sum(0.0, 4, weight, 9), 1U);
  EXPECT_EQ(index_at_sum(0.5, 4, weight, 9), 3U);
  EXPECT_EQ(index_at_sum(1.0, 4, weight, 9), 9U);
}

TEST(Stopwatch, NeverRunsBackwards) {
  const Stopwatch stopwatch;
  const double first = stopwatch.seconds();
  EXPECT_GE(first, 0.0);
  EXPECT_GE(stopwatch.seconds(), first);
}

}  // namespace
}  // namespace posemix
