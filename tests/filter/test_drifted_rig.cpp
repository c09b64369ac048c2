// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A body whose odometry drifts, with a camera on it whose pose there is uncertain, with the default
// settings: by the detections of a new place nothing can be told of one without the other.
#include <cstdint>
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

constexpr std::uint64_t kRigSeeds = 20;

const SE3d kDriftedBodyCamera = pose(0.1, -0.1, 0.05, 0.2, 0.1, 0);

/// Two tags, near the body where it starts.
std::vector<SE3d> two_tags() {
  const SE3d body = pose(0.1, 0.2, 0.3, 0, 0, 0);
  return {body * pose(0.3, -0.2, 0.5, 0.1, 0, 1), body * pose(-0.2, 0.3, 0.1, -0.3, 0.1, 1.2)};
}

struct RigDrift {
  double extrinsic_deg;
  double extrinsic_m;
  double drift_deg;
  double drift_m;
};

class DriftedRig : public ::testing::TestWithParam<RigDrift> {};

/// Standard deviation of the position of the camera on the body [m].
double extrinsic_sd(const TagTrip& trip) {
  return std::sqrt(trip.filter().extrinsic(0).covariance().bottomRightCorner<3, 3>().trace() / 3.0);
}

/// Nothing tells of the one camera that sees all: what is known of it stays what is stated.
TEST_P(DriftedRig, KnowsItsOnlyCameraAsBefore) {
  const RigDrift& drift = GetParam();
  NeesSummary body;
  NeesSummary extrinsic;
  NeesSummary seen;
  for (std::uint64_t seed = 1; seed <= kRigSeeds; ++seed) {
    TagTrip trip(seed, sharp_tag_noise(1e-3), two_tags());
    trip.see_from(kDriftedBodyCamera, isotropic(drift.extrinsic_deg, drift.extrinsic_m));
    for (int k = 0; k < 10; ++k) {
      trip.go(SE3d(), 1e-3, 1e-5);
      trip.see(0);
    }
    trip.go(SE3d(), drift.drift_deg, drift.drift_m);
    for (std::size_t k = 0; k < 30; ++k) {
      trip.see(k < 5 ? 1 : k % 2);
      trip.go(SE3d(), 1e-3, 1e-5);
    }
    EXPECT_NEAR(extrinsic_sd(trip) / drift.extrinsic_m, 1.0, 1e-3);
    body.add(trip.camera_nees());
    extrinsic.add(trip.extrinsic_nees());
    seen.add(trip.relative_nees(1));
  }
  expect_true_nees({body, extrinsic, seen});
}

/// A camera whose pose on the body is known saw the tag before; after the drift the other one sees
/// it again and again: the sum of drift and extrinsic is told, once.
TEST_P(DriftedRig, LearnsTheSumOfDriftAndExtrinsicAlone) {
  const RigDrift& drift = GetParam();
  NeesSummary body;
  NeesSummary extrinsic;
  for (std::uint64_t seed = 1; seed <= kRigSeeds; ++seed) {
    TagTrip trip(seed, sharp_tag_noise(Eigen::Vector3d::Constant(1e-3), 1e4), two_tags());
    trip.see_from(kDriftedBodyCamera, isotropic(drift.extrinsic_deg, drift.extrinsic_m));
    for (int k = 0; k < 10; ++k) trip.see_exactly(0);
    trip.go(SE3d(), drift.drift_deg, drift.drift_m);
    for (int k = 0; k < 50; ++k) trip.see(0);
    body.add(trip.camera_nees());
    extrinsic.add(trip.extrinsic_nees());
  }
  expect_true_nees({body, extrinsic});
}

INSTANTIATE_TEST_SUITE_P(
    All, DriftedRig,
    ::testing::Values(RigDrift{2.0, 0.02, 0.1, 0.05}, RigDrift{2.0, 0.02, 1.0, 1.0},
                      RigDrift{2.0, 0.02, 0.1, 5.0}, RigDrift{5.0, 0.05, 1.0, 0.1},
                      RigDrift{5.0, 0.05, 5.0, 0.05}, RigDrift{10.0, 0.1, 5.0, 0.05},
                      RigDrift{10.0, 0.1, 1.0, 0.1}));

}  // namespace
}  // namespace posemix
