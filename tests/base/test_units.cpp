// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/units.hpp"

#include <numbers>

#include <gtest/gtest.h>

namespace posemix {
namespace {

static_assert(radians(180.0) == std::numbers::pi);
static_assert(radians(0.0) == 0.0);

TEST(Units, DegreesInvertRadians) {
  for (const double angle : {-720.0, -90.0, -1e-9, 0.0, 1e-300, 57.29577951308232, 180.0, 1e6}) {
    EXPECT_DOUBLE_EQ(degrees(radians(angle)), angle);
  }
}

TEST(Units, OneRadianInDegrees) { EXPECT_DOUBLE_EQ(degrees(1.0), 57.295779513082320877); }

}  // namespace
}  // namespace posemix
