// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A camera whose odometry drifts by many standard deviations of the detector, as it says, with the
// default settings: what is seen again corrects the camera, and what was seen since moves with it.
#include <cstdint>

#include <gtest/gtest.h>

#include "drifted_camera_scene.hpp"

namespace posemix {
namespace {

using testing::draw;
using testing::expect_true_nees;
using testing::isotropic;
using testing::NeesSummary;
using testing::pose;
using testing::sharp_tag_noise;
using testing::TagTrip;

constexpr std::uint64_t kSeeds = 20;

struct DriftNees {
  NeesSummary camera;
  NeesSummary tag;       ///< the new one, in the world
  NeesSummary seen;      ///< the new one, from the camera
  NeesSummary all;       ///< camera and both tags
  NeesSummary all_seen;  ///< both tags from the camera
  NeesSummary beside;    ///< the new one from the other
};

/// A tag, the drift, a new tag, and both in turn.
DriftNees of_drift(double rotation_deg, double position_m, const DetectorNoise& noise) {
  const SE3d camera = pose(0.1, 0.2, 0.3, 0, 0, 0);
  DriftNees result;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    TagTrip trip(
        seed, noise,
        {camera * pose(0.3, -0.2, 0.5, 0.1, 0, 1), camera * pose(-0.2, 0.3, 0.1, -0.3, 0.1, 1.2)});
    for (int k = 0; k < 10; ++k) {
      trip.go(SE3d(), 1e-3, 1e-5);
      trip.see(0);
    }
    trip.go(SE3d(), rotation_deg, position_m);
    for (int k = 0; k < 5; ++k) {
      trip.see(1);
      trip.go(SE3d(), 1e-3, 1e-5);
    }
    for (std::size_t k = 0; k < 6; ++k) {
      trip.see(k % 2);
      trip.go(SE3d(), 1e-3, 1e-5);
    }
    result.camera.add(trip.camera_nees());
    result.tag.add(trip.tag_nees(1));
    result.seen.add(trip.relative_nees(1));
    result.all.add(trip.joint_nees());
    result.all_seen.add(trip.all_relative_nees());
    result.beside.add(trip.beside_nees());
  }
  return result;
}

struct CameraDrift {
  double rotation_deg;
  double position_m;
  Eigen::Vector3d tag_m;
  double volume_m3;
};

class DriftedCamera : public ::testing::TestWithParam<CameraDrift> {};

TEST_P(DriftedCamera, TellsWhereItIsAndWhatItSawSince) {
  const CameraDrift& drift = GetParam();
  const DriftNees nees =
      of_drift(drift.rotation_deg, drift.position_m, sharp_tag_noise(drift.tag_m, drift.volume_m3));
  expect_true_nees({nees.camera, nees.tag, nees.seen, nees.all});
}

/// Detections to the same position in all directions.
CameraDrift drift(double rotation_deg, double position_m, double tag_m, double volume_m3 = 1.0) {
  return {rotation_deg, position_m, Eigen::Vector3d::Constant(tag_m), volume_m3};
}

INSTANTIATE_TEST_SUITE_P(All, DriftedCamera,
                         ::testing::Values(drift(0.001, 0.1, 1e-3), drift(0.001, 1.0, 1e-3),
                                           drift(1.0, 1.0, 1e-3), drift(0.02, 1.0, 5e-3),
                                           drift(2.0, 3.0, 5e-3), drift(0.05, 1.0, 1e-4)));

// One correction does not take the camera where the detection is: its rotation, over the drift, is
// another position than that of the detector.
INSTANTIATE_TEST_SUITE_P(Far, DriftedCamera,
                         ::testing::Values(drift(1.0, 10.0, 1e-3, 1e6),
                                           drift(1.0, 3.0, 1e-4, 1e6)));

// The drift is far more than the error across the ray, and not than that along it.
INSTANTIATE_TEST_SUITE_P(AcrossTheRay, DriftedCamera,
                         ::testing::Values(CameraDrift{0.01, 0.1, {1e-3, 1e-3, 0.05}, 100.0},
                                           CameraDrift{0.01, 0.05, {1e-3, 1e-3, 0.03}, 1e3}));

/// A part of each correction is taken back by a shift of the world (eq. 10): all poses are as far
/// off in the world as the camera has drifted, as they say. In the logarithm of that common error
/// the sharp poses beside each other are bent, so that those count, not the joint covariance in the
/// world.
TEST(DriftedCamera, WithATypicalDetectorKnowsWhatItSaw) {
  for (const double position_m : {0.05, 1.0, 5.0}) {
    SCOPED_TRACE(position_m);
    const DetectorNoise noise = sharp_tag_noise(Eigen::Vector3d::Constant(3e-3), 1e4, true);
    const DriftNees nees = of_drift(1.0, position_m, noise);
    expect_true_nees({nees.camera, nees.tag, nees.seen, nees.all_seen, nees.beside});
  }
}

// A camera comes back to a tag, which it has seen to 0.1 mm, after a kilometre of drift, as is
// told.
TEST(DriftedCamera, FindsItselfAfterAKilometre) {
  const Matrix6d sharp = isotropic(1.0, 1e-4);
  const DetectorNoise noise({{0.95, sharp}}, {.weight = 0.05, .volume_m3 = 1.0});
  const Matrix6d still = isotropic(1e-4, 1e-4);
  const Matrix6d drift = isotropic(0.05, 1000.0);
  const SE3d camera = pose(0.1, 0.2, 0.3, 0.0, 0.0, 0.0);
  const SE3d seen = pose(0.3, -0.2, 0.5, 0.1, 0.0, 1.0);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream stream(seed, 5);
    MultiObjectFilter filter({camera, isotropic(1e-3, 1e-3)}, {{noise}}, {});
    const auto see = [&] { filter.update(0, seen * SE3d::exp(draw(sharp, stream))); };
    for (int k = 0; k < 10; ++k) {
      filter.predict_with_odometry(SE3d(), still, 0.1);
      see();
    }
    filter.predict_with_odometry(SE3d::exp(draw(drift, stream)).inverse(), drift, 1.0);
    for (int k = 0; k < 5; ++k) {
      see();
      filter.predict_with_odometry(SE3d(), still, 0.1);
    }
    EXPECT_LT((filter.camera().mean().translation() - camera.translation()).norm(), 0.1) << seed;
  }
}

}  // namespace
}  // namespace posemix
