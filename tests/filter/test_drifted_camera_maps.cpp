// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Maps of many places that a camera makes whose odometry drifts between them by many standard
// deviations of the detector, with the default settings.
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "drifted_camera_scene.hpp"

namespace posemix {
namespace {

using testing::NeesSummary;
using testing::pose;
using testing::sharp_tag_noise;
using testing::TagTrip;

/// A loop of places, in each of which the tag of the place before is seen again.
NeesSummary of_loop(std::size_t places, std::uint64_t seeds, double position_m) {
  const SE3d step = pose(0, 0, 2 * std::numbers::pi / static_cast<double>(places), 1, 0, 0);
  std::vector<SE3d> tags;
  SE3d at = pose(0.1, 0.2, 0.3, 0, 0, 0);
  for (std::size_t i = 0; i < places; ++i) {
    const auto k = static_cast<double>(i % 4);
    tags.push_back(at * pose(0.3 * (k - 1.0), -0.1 * k, 0.5, 0.1, 0.05 * k, 1));
    at = at * step;
  }
  NeesSummary result;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    TagTrip trip(seed, sharp_tag_noise(1e-3), tags);
    for (std::size_t i = 0; i < places; ++i) {
      if (i > 0) trip.go(step, 0.2, position_m);
      for (int k = 0; k < 5; ++k) {
        trip.see(i);
        if (i > 0 && k == 0) trip.see(i - 1);
        trip.go(SE3d(), 1e-3, 1e-4);
      }
    }
    trip.go(step, 0.2, position_m);
    for (int k = 0; k < 3; ++k) trip.see(0);
    for (std::size_t i = 0; i < places; ++i) result.add(trip.tag_nees(i));
  }
  return result;
}

TEST(DriftedCameraMaps, ALoop) {
  for (const double position_m : {0.03, 0.1, 0.3}) {
    const NeesSummary nees = of_loop(10, 20, position_m);
    EXPECT_GT(nees.mean(), 0.7) << position_m;
    EXPECT_LT(nees.mean(), 1.4) << position_m;
    EXPECT_LT(nees.worst, 8.0) << position_m;
  }
}

/// So many that most become passive before the loop closes.
TEST(DriftedCameraMaps, ALoopOfManyPlaces) {
  const NeesSummary nees = of_loop(60, 4, 0.3);
  EXPECT_GT(nees.mean(), 0.5);
  EXPECT_LT(nees.mean(), 1.4);
  EXPECT_LT(nees.worst, 8.0);
}

/// What was seen since a drift is known far worse than a detection tells until the loop closes.
TEST(DriftedCameraMaps, ManyPlacesAfterADrift) {
  constexpr std::size_t kTags = 60;
  std::vector<SE3d> tags;
  for (std::size_t i = 0; i < kTags; ++i) {
    const double k = static_cast<double>(i);
    tags.push_back(pose(0.1, 0.2, 0.3, 0, 0, 0) * pose(0, 0, 0, 0.1 * k, 0, 0) *
                   pose(0.2 * static_cast<double>(i % 3), -0.3, 0.4, 0.1, 0, 0.6));
  }
  NeesSummary relative;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    TagTrip trip(seed, sharp_tag_noise(Eigen::Vector3d::Constant(1e-3), 1e4), tags);
    for (int k = 0; k < 10; ++k) {
      trip.see(0);
      trip.go(SE3d(), 1e-3, 1e-5);
    }
    trip.go(pose(0, 0, 0, 0.1, 0, 0), 1.0, 3.0);
    for (int round = 0; round < 2; ++round) {
      for (std::size_t i = 1; i < kTags; ++i) {
        for (int k = 0; k < 2; ++k) {
          trip.see(i);
          if (i > 1) trip.see(i - 1);
        }
        trip.go(i + 1 < kTags ? pose(0, 0, 0, 0.1, 0, 0)
                              : pose(0, 0, 0, -0.1 * static_cast<double>(kTags - 2), 0, 0),
                0.02, 5e-4);
      }
    }
    for (int k = 0; k < 3; ++k) trip.see(0);
    for (std::size_t i = 0; i < kTags; ++i) relative.add(trip.relative_nees(i));
  }
  EXPECT_GT(relative.mean(), 0.5);
  EXPECT_LT(relative.mean(), 2.0);
  EXPECT_LT(relative.worst, 10.0);
}

}  // namespace
}  // namespace posemix
