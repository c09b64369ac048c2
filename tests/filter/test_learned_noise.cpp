// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "drifted_camera_scene.hpp"
#include "multi_object_scene.hpp"

/// What the multi-object filter learns of a detector, with the settings as they ship.
namespace posemix {
namespace {

using testing::draw;
using testing::isotropic;
using testing::OrbitScene;
using testing::pose;

const Matrix6d kWhite = isotropic(2.0, 0.005);
const Matrix6d kLasting = isotropic(2.5, 0.005);
const Matrix6d kExact = isotropic(1e-4, 1e-6);

/// A robot that stands or circles an object, and a detector whose white error is `white` times what
/// the filter is told. The slow error changes with the view alone.
struct Robot {
  Robot(std::uint64_t seed, const NoiseDependence& dependence)
      : stream(seed, 3),
        filter(ConcentratedGaussian<SE3d>(OrbitScene::camera_at(0), kExact),
               {{DetectorNoise({{.weight = 0.95, .covariance = kWhite, .frame = NoiseFrame::ray}},
                               {.weight = 0.05}, dependence)}},
               {}) {
    if (dependence.slow) {
      slow = dependence.slow;
      b = draw(slow->covariance, stream);
    }
    if (dependence.common) truth = truth_known * SE3d::exp(draw(*dependence.common, stream));
  }

  Eigen::Vector3d view() const { return (truth.inverse() * camera).translation().normalized(); }

  /// Sees the object from the place where it is, or from the next one; returns whether the
  /// detection began another hypothesis.
  bool see(bool drives, double white) {
    const Eigen::Vector3d before = view();
    if (drives) ++frame;
    const SE3d next = OrbitScene::camera_at(frame);
    filter.predict_with_odometry(camera.inverse() * next * SE3d::exp(draw(odometry, stream)),
                                 odometry, 0.1);
    camera = next;
    if (slow) {
      const double angle = std::acos(std::min(1.0, before.dot(view())));
      const double a = slow->correlation(0.1, angle);
      b = a * b + std::sqrt(1.0 - a * a) * draw(slow->covariance, stream);
    }
    // The error in common is that of the truth against what the detector takes for it. The others
    // are along the ray, their translation a part of the range.
    const SE3d shown = camera.inverse() * truth_known;
    const NoiseAtPose at = noise_at({.covariance = kWhite, .frame = NoiseFrame::ray}, shown);
    Vector6d error = b + white * draw(kWhite, stream) + wrong;
    error.tail<3>() *= shown.translation().norm();
    return filter.update(0, at.axes * SE3d::exp(error) * at.axes.inverse() * shown).started;
  }

  ConcentratedGaussian<SE3d> estimate() const { return filter.relative(0, *filter.leading(0)); }
  /// Of the pose from the camera, per degree of freedom.
  double nees() const {
    const auto found = estimate();
    const Vector6d error = (camera.inverse() * truth * found.mean().inverse()).log();
    return error.dot(found.covariance().llt().solve(error)) / 6.0;
  }

  RandomStream stream;
  Matrix6d odometry = isotropic(1e-5, 1e-7);  ///< covariance of its error
  SE3d truth_known = pose(0.3, -0.2, 0.5, 0.1, -0.05, 0.05);
  SE3d truth = truth_known;
  std::optional<SlowError> slow;
  Vector6d b = Vector6d::Zero();
  Vector6d wrong = Vector6d::Zero();  ///< added to every error
  int frame = 0;
  SE3d camera = OrbitScene::camera_at(0);
  MultiObjectFilter filter;
};

NoiseDependence slow_with_the_view(bool is_typical = false) {
  return {
      .slow = SlowError{.covariance = kLasting, .correlation_angle_rad = 0.5 * std::numbers::pi},
      .is_typical = is_typical};
}

const char* name(bool is_typical) { return is_typical ? "typical" : "stated"; }

// A picture that stays the same has small innovations whatever the slow error is. The scale of the
// slow error went down with them, and the NEES was 20 to 40.
TEST(LearnedNoise, StandingStillIsNoEvidenceAgainstTheSlowError) {
  constexpr int kRuns = 20;
  for (const bool is_typical : {true, false}) {
    for (const double white : {1.0, 0.3, 0.1}) {
      double sum = 0.0;
      for (int run = 0; run < kRuns; ++run) {
        Robot robot(static_cast<std::uint64_t>(run), slow_with_the_view(is_typical));
        for (int i = 0; i < 300; ++i) robot.see(false, white);
        sum += robot.nees() / kRuns;
      }
      std::printf("standing still, %s, white error times %.1f: NEES %.2f\n", name(is_typical),
                  white, sum);
      EXPECT_GT(sum, 0.5) << white;
      EXPECT_LT(sum, 1.8) << white;
    }
  }
}

// Odometry of a camera trembles: the sum of its steps is no change of view.
TEST(LearnedNoise, OdometryThatTremblesIsNoChangeOfTheView) {
  constexpr int kRuns = 20;
  for (const bool is_typical : {true, false}) {
    for (const double degrees : {0.003, 0.01, 0.03}) {
      double sum = 0.0;
      for (int run = 0; run < kRuns; ++run) {
        Robot robot(static_cast<std::uint64_t>(run), slow_with_the_view(is_typical));
        robot.odometry = isotropic(degrees, 1e-5);
        for (int i = 0; i < 300; ++i) robot.see(false, 0.1);
        sum += robot.nees() / kRuns;
      }
      std::printf("odometry of %.3f deg, %s: NEES %.2f\n", degrees, name(is_typical), sum);
      EXPECT_LT(sum, 1.8) << degrees;
    }
  }
}

// After that, detections as they were stated were taken for wrong ones for minutes: 97 % of them
// began hypotheses, and the NEES was 22.
TEST(LearnedNoise, ARobotThatDrivesOnAfterStandingStillBelievesItsDetector) {
  constexpr int kRuns = 10;
  constexpr int kFrames = 300;
  for (const bool is_typical : {true, false}) {
    double nees = 0.0;
    double refused = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      Robot robot(static_cast<std::uint64_t>(run), slow_with_the_view(is_typical));
      for (int i = 0; i < 600; ++i) robot.see(false, 0.1);
      for (int i = 0; i < kFrames; ++i) {
        if (robot.see(true, 1.0)) refused += 1.0 / (kRuns * kFrames);
        if (i >= 50) nees += robot.nees() / (kRuns * (kFrames - 50));
      }
    }
    std::printf("driving on, %s: %.1f %% of the detections begin hypotheses, NEES %.2f\n",
                name(is_typical), 100 * refused, nees);
    EXPECT_LT(refused, 0.1);
    EXPECT_LT(nees, 2.0);
  }
}

// A wrong mode is seen in runs. Inliers by the noise as stated, their errors are alike: after five
// of them the filter had believed all that the noise as stated allows.
TEST(LearnedNoise, ErrorsThatAreAlikeUndoNothing) {
  Robot robot(0, slow_with_the_view(true));
  for (int i = 0; i < 600; ++i) robot.see(false, 0.1);
  robot.wrong = 1.5 * kWhite.diagonal().cwiseSqrt();
  for (int i = 0; i < 15; ++i) robot.see(false, 0.1);
  int refused = 0;
  for (int i = 0; i < 5; ++i) {
    robot.wrong = -robot.wrong;
    refused += robot.see(false, 0.1) ? 1 : 0;
  }
  EXPECT_GE(refused, 3);
}

// Where the noise is stated, a small white error says nothing of the slow one: the NEES was 5.7 at
// a tenth.
TEST(LearnedNoise, AStatedSlowErrorKeepsItsSize) {
  constexpr int kRuns = 20;
  for (const double white : {0.3, 0.1}) {
    double sum = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      Robot robot(static_cast<std::uint64_t>(run), slow_with_the_view());
      for (int i = 0; i < 300; ++i) robot.see(true, white);
      sum += robot.nees() / kRuns;
    }
    std::printf("circling, white error times %.1f: NEES %.2f\n", white, sum);
    EXPECT_GT(sum, 0.5) << white;
    EXPECT_LT(sum, 1.8) << white;
  }
}

// No detection tells of it, and so no scale that is learned from detections is its own.
TEST(LearnedNoise, TheErrorInCommonKeepsItsSize) {
  constexpr int kRuns = 30;
  double nees = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    Robot robot(static_cast<std::uint64_t>(run), {.common = kLasting});
    for (int i = 0; i < 150; ++i) robot.see(true, 0.15);
    nees += robot.nees() / kRuns;
    EXPECT_GT(robot.estimate().covariance()(0, 0), 0.95 * kLasting(0, 0));
  }
  std::printf("error in common, white error times 0.15: NEES %.2f\n", nees);
  EXPECT_LT(nees, 1.6);
}

// Directions that are opposite to the last bit turn about no axis, and were one view.
/// Of a tag from the camera, after many frames with a motion that is quieter than it is said to be.
/// `go` moves the camera by a frame.
template <class Go>
testing::NeesSummary nees_after_quiet(const Go& go) {
  const std::vector<SE3d> tags{pose(0.4, 0, 0.8, 0.4, 0.2, 1.3),
                               pose(-0.1, 0.5, 0.4, -0.2, 0.3, 1.5),
                               pose(1.0, 0.4, 0.3, 0.2, -0.2, 1.8)};
  testing::NeesSummary nees;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    testing::TagTrip trip(seed, testing::sharp_tag_noise(2e-3), tags);
    for (std::size_t k = 0; k < 5000; ++k) {
      go(trip);
      trip.see(k / 2 % 3);
    }
    nees.add(trip.relative_nees(0));
  }
  return nees;
}

/// Of a motion that is quieter than it is said to be nothing is learned of the detector.
TEST(LearnedNoise, AQuietMotionIsNoQuietDetector) {
  for (const double q : {0.05, 0.15, 0.5}) {
    const Matrix6d said = isotropic(q, 0.01 * q);
    const auto walk = nees_after_quiet([&](testing::TagTrip& trip) { trip.stand(said); });
    const auto odometry = nees_after_quiet(
        [&](testing::TagTrip& trip) { trip.go(SE3d(), said, isotropic(0.1 * q, 1e-3 * q)); });
    for (const testing::NeesSummary& nees : {walk, odometry}) {
      EXPECT_LT(nees.mean(), 1.8) << q;
      EXPECT_LT(nees.worst, 4.0) << q;
    }
  }
}

TEST(SlowError, TheOppositeSideIsAnotherView) {
  const auto variance_at = [](const Eigen::Vector3d& place) {
    const SE3d before(SO3d(), {0.0, 0.0, -1.0});
    const SE3d after(SO3d(), place);
    MultiObjectFilter filter(ConcentratedGaussian<SE3d>(before, kExact),
                             {{DetectorNoise({{.weight = 0.95, .covariance = kWhite}},
                                             {.weight = 0.05}, slow_with_the_view())}},
                             {});
    filter.update(0, before.inverse());
    filter.predict_with_odometry(before.inverse() * after, isotropic(1e-5, 1e-7), 0.1);
    filter.update(0, after.inverse());
    return filter.relative(0, *filter.leading(0)).covariance().trace();
  };
  const double near = variance_at(Eigen::Vector3d(0.0, 1e-3, 1.0).normalized());
  EXPECT_NEAR(variance_at({0.0, 0.0, 1.0}) / near, 1.0, 1e-2);
  EXPECT_GT(variance_at({0.0, 0.0, -1.0}) / near, 1.2);
}

}  // namespace
}  // namespace posemix
