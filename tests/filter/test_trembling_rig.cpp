// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A body with one camera whose pose on it is uncertain, which stands or drives on a plane, with the
// default settings: by the noise of its odometry nothing is told of that pose.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "drifted_camera_scene.hpp"

namespace posemix {
namespace {

using testing::expect_true_nees;
using testing::isotropic;
using testing::NeesSummary;
using testing::pose;
using testing::sharp_tag_noise;
using testing::TagTrip;

constexpr std::uint64_t kTremblingSeeds = 12;
constexpr int kTremblingFrames = 1000;

const SE3d kTremblingCamera = pose(0.2, 0.1, 0.0, 0.1, -0.1, 0.05);
const Matrix6d kTrembling = isotropic(0.1, 1e-3);

std::vector<SE3d> three_tags() {
  const SE3d body = pose(0.1, 0.2, 0.3, 0, 0, 0);
  return {body * pose(0.3, -0.2, 0.5, 0.3, 0, 1), body * pose(-0.2, 0.3, 0.1, -0.5, 0.2, 1.2),
          body * pose(0.9, 0.2, 0, 0.1, -0.4, 1.5)};
}

/// The camera's pose on the body has an error of so many degrees and centimetres.
TagTrip trembling_trip(std::uint64_t seed, double uncertain) {
  TagTrip trip(seed, sharp_tag_noise(2e-3), three_tags());
  trip.see_from(kTremblingCamera, isotropic(uncertain, 0.01 * uncertain));
  return trip;
}

struct TremblingNees {
  NeesSummary body;
  NeesSummary extrinsic;
  NeesSummary tag;        ///< from the body
  double least_sd = 1.0;  ///< of the position of the camera on the body along any of its axes [m]
};

/// `go` moves the body by a frame.
template <class Go>
TremblingNees nees_after(const Go& go, double uncertain = 5.0,
                         std::uint64_t seeds = kTremblingSeeds) {
  TremblingNees nees;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    TagTrip trip = trembling_trip(seed, uncertain);
    for (std::size_t k = 0; k < kTremblingFrames; ++k) {
      go(trip);
      trip.see(k / 2 % 3);
    }
    nees.body.add(trip.camera_nees());
    nees.extrinsic.add(trip.extrinsic_nees());
    nees.tag.add(trip.relative_nees(0));
    const Matrix6d covariance = trip.filter().extrinsic(0).covariance();
    nees.least_sd = std::min(nees.least_sd, std::sqrt(covariance.diagonal().tail<3>().minCoeff()));
  }
  return nees;
}

TEST(TremblingRig, LearnsNothingWhereItStands) {
  const TremblingNees odometry = nees_after([](TagTrip& trip) { trip.go(SE3d(), kTrembling); });
  const TremblingNees given =
      nees_after([](TagTrip& trip) { trip.go_and_give(SE3d(), kTrembling); });
  for (const TremblingNees& nees : {odometry, given}) {
    expect_true_nees({nees.extrinsic, nees.tag});
    EXPECT_GT(nees.least_sd, 0.045);
  }
}

TEST(TremblingRig, LearnsNothingWhereItsCamerasAloneTellHowItMoves) {
  for (const SE3d& motion : {SE3d(), pose(0, 0, 0.01, 5e-3, 0, 0)}) {
    const TremblingNees nees = nees_after(
        [&](TagTrip& trip) { trip.go_on(motion, isotropic(0.02, 2e-4), isotropic(0.1, 1e-3)); });
    expect_true_nees({nees.extrinsic, nees.tag});
    EXPECT_GT(nees.least_sd, 0.049);
  }
}

/// A degree per second at ten images per second, say: the body is where it is said to be all the
/// same.
TEST(TremblingRig, LearnsNothingOfAMotionWithinTheNoise) {
  const SE3d motion = pose(0, 0, 0.1 * std::numbers::pi / 180.0, 1e-3, 0, 0);
  const TremblingNees nees = nees_after([&](TagTrip& trip) { trip.go(motion, kTrembling); }, 2.0);
  expect_true_nees({nees.extrinsic, nees.tag, nees.body});
  EXPECT_GT(nees.least_sd, 0.018);
}

/// On a plane it learns all but the height of its camera, with what (20) leaves out at 5 deg.
TEST(TremblingRig, LearnsTruthOnAPlane) {
  for (const SE3d& tilt : {SE3d(), pose(0.5, 0.3, 0, 0, 0, 0)}) {
    const SE3d motion = tilt * pose(0, 0, 0.03, 0.01, 0, 0) * tilt.inverse();
    const auto drives = [&](TagTrip& trip) { trip.go(motion, kTrembling); };
    const auto is_given = [&](TagTrip& trip) { trip.go_and_give(motion, kTrembling); };
    for (const TremblingNees& nees : {nees_after(drives, 2.0), nees_after(is_given, 2.0)})
      expect_true_nees({nees.extrinsic, nees.tag});
    for (const TremblingNees& nees : {nees_after(drives, 5.0), nees_after(is_given, 5.0)})
      EXPECT_LT(nees.extrinsic.mean(), 2.0);
  }
}

struct TwoCameras {
  double detector_deg = 1.0;
  double detector_m = 2e-3;
  double other_deg = 0.0;  ///< of the other camera's pose on the body; 0: exact
};

/// Two cameras that see different tags, both in every frame.
template <class Go>
TremblingNees nees_of_two(const TwoCameras& cameras, const Go& go, double uncertain = 5.0) {
  const SE3d body = pose(0.1, 0.2, 0.3, 0, 0, 0);
  std::vector<SE3d> tags = three_tags();
  tags[2] = body * pose(0.9, 0.2, 0, 0.1, -0.4, -1.5);
  const Matrix6d noise = isotropic(cameras.detector_deg, cameras.detector_m);
  const DetectorNoise detector({{.weight = 0.95, .covariance = noise}},
                               {.weight = 0.05, .volume_m3 = 1.0});
  const bool is_exact = cameras.other_deg == 0.0;
  TremblingNees nees;
  for (std::uint64_t seed = 1; seed <= kTremblingSeeds; ++seed) {
    TagTrip trip(seed, detector, tags);
    const Matrix6d other = isotropic(cameras.other_deg, 0.01 * cameras.other_deg);
    if (!is_exact) trip.see_from(pose(3.0, 0.1, 0, 0.1, -0.1, -0.05), other);
    trip.see_from(kTremblingCamera, isotropic(uncertain, 0.01 * uncertain));
    for (std::size_t k = 0; k < kTremblingFrames; ++k) {
      go(trip);
      trip.see(k / 4 % 2);
      if (!is_exact) trip.see_with(0, 2);
      if (is_exact) trip.see_exactly(2);
    }
    nees.extrinsic.add(trip.extrinsic_nees());
    nees.tag.add(trip.relative_nees(0));
    nees.body.add(trip.relative_nees(2));
  }
  return nees;
}

TEST(TremblingRig, LearnsNothingFromCamerasThatSeeDifferentTags) {
  const auto drives = [](TagTrip& trip) { trip.go(pose(0, 0, 0.03, 0.01, 0, 0), kTrembling); };
  const auto stands = [](TagTrip& trip) { trip.go(SE3d(), kTrembling); };
  const auto is_given = [](TagTrip& trip) { trip.go_and_give(SE3d(), kTrembling); };
  for (const double other : {0.0, 5.0}) {
    const TwoCameras cameras{.other_deg = other};
    for (const TremblingNees& nees : {nees_of_two(cameras, stands), nees_of_two(cameras, is_given)})
      expect_true_nees({nees.extrinsic, nees.tag, nees.body});
    const TremblingNees nees = nees_of_two(cameras, drives);
    EXPECT_LT(nees.extrinsic.mean(), 2.5);
    expect_true_nees({nees.tag, nees.body});
  }
}

/// A few standard deviations of the odometry per frame, beside an exact camera, which tells of it:
/// with a poor detector it was wrong by 13 in place of 1.
TEST(TremblingRig, LearnsLittleFromASlowMotionBesideAnExactCamera) {
  const auto slow = [](TagTrip& trip) { trip.go(pose(0, 0, 5e-3, 3e-3, 0, 0), kTrembling); };
  EXPECT_LT(nees_of_two({}, slow).extrinsic.mean(), 3.0);
  const Matrix6d half = isotropic(0.05, 5e-4);
  const auto slower = [&](TagTrip& trip) { trip.go(pose(0, 0, 1e-3, 2e-3, 0, 0), half); };
  const TremblingNees poor = nees_of_two({.detector_deg = 10.0, .detector_m = 0.05}, slower);
  expect_true_nees({poor.extrinsic, poor.tag, poor.body});
}

/// A pose that is given with a poor one among good ones, or first.
TEST(TremblingRig, LearnsTruthBesidePoorPoses) {
  const Matrix6d poor = isotropic(10.0, 1.0);
  for (const int every : {10, kTremblingFrames}) {
    int frame = 0;
    const auto is_given = [&](TagTrip& trip) {
      const bool is_poor = frame++ % kTremblingFrames % every == 0;
      trip.go_and_give(pose(0, 0, 0.03, 0.01, 0, 0), is_poor ? poor : kTrembling);
    };
    const TremblingNees nees = nees_after(is_given, 5.0, 4 * kTremblingSeeds);
    EXPECT_LT(nees.extrinsic.mean(), 2.0) << every;
    EXPECT_LT(nees.tag.mean(), 2.0) << every;
  }
}

}  // namespace
}  // namespace posemix
