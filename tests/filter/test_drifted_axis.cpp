// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A camera whose odometry drifts, and that sees a new object with an axis of symmetry, with the
// default settings: that tells nothing of where the camera is.
#include <cmath>
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

/// The least standard deviation of the camera's rotation in any direction [deg].
double least_rotation_sd_deg(const TagTrip& trip) {
  const Eigen::Matrix3d covariance = trip.filter().camera().covariance().topLeftCorner<3, 3>();
  return degrees(std::sqrt(covariance.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff()));
}

/// A known tag, the drift, a new object, and the tag again.
void expect_true(double drift_deg, const ObjectSensor& symmetric, int detections) {
  const SE3d camera = pose(0.1, 0.2, 0.3, 0, 0, 0);
  const std::vector<SE3d> places{camera * pose(0.3, -0.2, 0.5, 0.1, 0, 1),
                                 camera * pose(-0.2, 0.3, 0.1, -0.3, 0.1, 1.2)};
  NeesSummary before;
  NeesSummary after;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    TagTrip trip(seed, {ObjectSensor{symmetric.noise}, symmetric}, places);
    for (int k = 0; k < 10; ++k) {
      trip.see(0);
      trip.go(SE3d(), 1e-3, 1e-5);
    }
    trip.go(SE3d(), drift_deg, 0.1);
    for (int k = 0; k < detections; ++k) {
      trip.see(1, trip.any_turn());
      trip.go(SE3d(), 0.02, 5e-4);
    }
    EXPECT_GT(least_rotation_sd_deg(trip), 0.99 * drift_deg) << seed;
    before.add(trip.camera_nees());
    EXPECT_LT(trip.see(0).clutter_probability, 0.1) << seed;
    for (int k = 0; k < 5; ++k) {
      trip.go(SE3d(), 0.02, 5e-4);
      trip.see(0);
    }
    after.add(trip.camera_nees());
  }
  expect_true_nees({before, after});
}

TEST(DriftedCameraAndAxis, ANewBottleTellsNothingOfTheCamera) {
  const DetectorNoise noise = sharp_tag_noise(Eigen::Vector3d::Constant(1e-3), 1e4);
  const ObjectSensor bottle{noise, SymmetryGroup::turns({0, 0, 1}, 0)};
  for (const double drift_deg : {3.0, 10.0, 20.0, 60.0}) {
    for (const int detections : {1, 5, 30}) {
      SCOPED_TRACE(::testing::Message() << drift_deg << " deg, " << detections);
      expect_true(drift_deg, bottle, detections);
    }
  }
}

TEST(DriftedCameraAndAxis, ANewBallTellsNothingOfTheCamera) {
  const DetectorNoise noise = sharp_tag_noise(Eigen::Vector3d::Constant(1e-3), 1e4);
  for (const double drift_deg : {3.0, 20.0})
    expect_true(
        drift_deg,
        {noise, SymmetryGroup({}, {{Eigen::Vector3d::UnitZ()}, {Eigen::Vector3d::UnitX()}})}, 30);
}

/// The largest standard deviation of the camera's rotation in any direction [deg].
double largest_rotation_sd_deg(const TagTrip& trip) {
  const Eigen::Matrix3d covariance = trip.filter().camera().covariance().topLeftCorner<3, 3>();
  return degrees(std::sqrt(covariance.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff()));
}

/// The camera has turned about the axis of a bottle that is known, and sees nothing but the bottle.
void expect_unknown_turn(double drift_deg, const DetectorNoise& noise) {
  const SE3d place = pose(0.1, 0.2, 0.3, 0, 0, 0) * pose(-0.2, 0.3, 0.1, -0.3, 0.1, 1.2);
  NeesSummary camera;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    TagTrip trip(seed, {{noise, SymmetryGroup::turns({0, 0, 1}, 0)}}, {place});
    for (int k = 0; k < 10; ++k) {
      trip.see(0, trip.any_turn());
      trip.go(SE3d(), 1e-3, 1e-5);
    }
    const Vector6d turn = (trip.camera().inverse() * place).adjoint() * Vector6d(Vector6d::Unit(2));
    trip.go(SE3d(),
            isotropic(1e-3, 1e-5) + std::pow(radians(drift_deg), 2) * turn * turn.transpose());
    for (int k = 0; k < 300; ++k) trip.see(0, trip.any_turn());
    camera.add(trip.camera_nees());
    EXPECT_GT(largest_rotation_sd_deg(trip), 0.4 * drift_deg) << seed;
  }
  expect_true_nees({camera});
}

TEST(DriftedCameraAndAxis, AKnownBottleTellsNothingOfATurnAboutIt) {
  for (const double drift_deg : {5.0, 20.0})
    expect_unknown_turn(drift_deg, sharp_tag_noise(Eigen::Vector3d::Constant(1e-3), 1e4));
}

/// Beside the angle that is not told, micrometres are not lost by rounding.
TEST(DriftedCameraAndAxis, ASharpDetectorTellsNothingOfASmallTurn) {
  expect_unknown_turn(0.5, DetectorNoise({{.weight = 0.95, .covariance = isotropic(1e-3, 1e-6)}},
                                         {.weight = 0.05, .volume_m3 = 1e4}));
}

}  // namespace
}  // namespace posemix
