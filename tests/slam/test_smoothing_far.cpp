// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "posemix/slam/smoothing.hpp"
#include "posemix/testing/expect.hpp"
#include "smoothing_scene.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::kR;
using testing::kStart;

/// The camera goes on by odometry, in five frames, and sees nothing, or the second object, which
/// was not seen before, beside it.
void drive_away(Sequence& sequence, double distance, bool sees_another = false) {
  if (sees_another) std::ranges::fill(sequence.objects[1].detections, std::nullopt);
  for (int k = 1; k <= 5; ++k) {
    const SE3d step(SO3d(), {0.2 * distance, 0.0, 0.0});
    sequence.stamps.push_back(sequence.stamps.back() + 0.1);
    sequence.odometry.emplace_back(*sequence.odometry.back() * step);
    sequence.camera_truth.emplace_back(*sequence.camera_truth.back() * step);
    for (ObjectRecording& object : sequence.objects) {
      object.detections.emplace_back();
      object.world_truth.push_back(object.world_truth.back());
    }
  }
  if (sees_another) sequence.objects[1].detections.back() = testing::pose(0, 0, 0, 0, 0, 0.5);
}

/// Two objects before a camera in a world whose origin is elsewhere, smoothed by the default
/// filter.
SlamRun smoothed_at(const SE3d& world, std::size_t lag, MotionModel model, double drive_m = 0.0,
                    bool sees_another = false, const Matrix6d& white = kR) {
  Sequence sequence = testing::drawn_sequence(3, 2);
  if (drive_m > 0.0) drive_away(sequence, drive_m, sees_another);
  ObjectSlamSettings settings = testing::plain_slam_settings();
  settings.tracker = MultiObjectSlamSettings{};
  settings.motion.model = model;
  if (model == MotionModel::given) {
    settings.motion.noise.covariance = isotropic(0.2, 0.003);
    for (std::size_t k = 0; k < sequence.stamps.size(); ++k)
      if (sequence.odometry[k]) sequence.odometry[k] = world * *sequence.camera_truth[k];
  }
  const SE3d place(SO3d(), kStart.translation());
  const Matrix6d start = (world * place).adjoint_congruence(isotropic(0.5, 0.005));
  const DetectorNoise noise({{.weight = 0.9, .covariance = white}},
                            {.weight = 0.1, .volume_m3 = 1.0});
  return run_smoothed(sequence, {world * kStart, start}, testing::models_with(noise, 2), settings,
                      {.lag_frames = lag});
}

/// In standard deviations of `a`.
double apart(const PoseDensity& a, const SE3d& b) {
  const Vector6d xi = (a.mean() * b.inverse()).log();
  return std::sqrt(xi.dot(a.covariance().llt().solve(xi)));
}

void expect_same(const PoseDensity& near, const SE3d& mean, const Matrix6d& covariance,
                 double tolerance) {
  EXPECT_LT(apart(near, mean), tolerance);
  EXPECT_LT((covariance - near.covariance()).norm(), tolerance * near.covariance().norm());
}

TEST(SmoothingFarAway, IsWhatItIsNearTheOrigin) {
  for (const MotionModel model : {MotionModel::odometry, MotionModel::given}) {
    for (const std::size_t lag : {0, 5}) {
      const SlamRun near = smoothed_at(SE3d(), lag, model);
      for (const double distance : {100.0, 3e3, 1e5}) {
        const SE3d world(SO3d(), {distance, -0.6 * distance, 0.1 * distance});
        const SlamRun far = smoothed_at(world, lag, model);
        const SE3d back = world.inverse();
        const double tolerance = distance < 1e4 ? 1e-5 : 5e-3;
        ASSERT_EQ(far.frames.size(), near.frames.size());
        for (std::size_t k = 0; k < near.frames.size(); ++k) {
          const FrameEstimate& a = near.frames[k];
          const FrameEstimate& b = far.frames[k];
          expect_same(a.camera, back * b.camera.mean(),
                      back.adjoint_congruence(b.camera.covariance()), tolerance);
          for (std::size_t j = 0; j < 2; ++j) {
            ASSERT_EQ(a.relative[j].has_value(), b.relative[j].has_value());
            if (!a.relative[j]) continue;
            expect_same(*a.relative[j], b.relative[j]->mean(), b.relative[j]->covariance(),
                        tolerance);
          }
        }
      }
    }
  }
}

TEST(SmoothingFarAway, OfWhatWasSeenStaysWhenTheCameraDrivesAway) {
  const SlamRun near = smoothed_at(SE3d(), 0, MotionModel::odometry, 0.01);
  for (const double distance : {100.0, 2e3, 1e5}) {
    const SlamRun far = smoothed_at(SE3d(), 0, MotionModel::odometry, distance);
    for (std::size_t k = 0; k + 5 < near.frames.size(); ++k) {
      for (std::size_t j = 0; j < 2; ++j) {
        const auto& a = near.frames[k].relative[j];
        const auto& b = far.frames[k].relative[j];
        ASSERT_EQ(a.has_value(), b.has_value());
        if (a) expect_same(*a, b->mean(), b->covariance(), 1e-4);
      }
    }
  }
}

/// Beside what is not known of an object so far away, what its detector sees would be lost.
TEST(SmoothingFarAway, ObjectsThatAreTooFarFromTheFirstCameraAreRefused) {
  const auto smoothed = [](std::size_t lag, double distance) {
    return smoothed_at(SE3d(), lag, MotionModel::odometry, distance, true);
  };
  EXPECT_NO_THROW(smoothed(0, 500.0));
  EXPECT_NO_THROW(smoothed(1, 3e3));
  for (const double distance : {2e3, 3e3, 1e4}) {
    EXPECT_EQ(posemix::testing::thrown_message([&] { smoothed(0, distance); }),
              "smoothing: object '1' is so far from where the camera begins that double precision "
              "does not hold what its detector sees, expected a shorter way, a lag of a few "
              "frames, or a run that is not smoothed")
        << distance;
  }
}

/// Of a detector whose errors are correlated the smallest one counts.
TEST(SmoothingFarAway, ADetectorIsAsFineAsItIsAlongAnyDirection) {
  Matrix6d correlated = kR;
  correlated(3, 4) = correlated(4, 3) = 0.999 * kR(3, 3);
  const auto smoothed = [&](double distance) {
    return smoothed_at(SE3d(), 0, MotionModel::odometry, distance, true, correlated);
  };
  EXPECT_NO_THROW(smoothed(20.0));
  EXPECT_THROW(smoothed(300.0), InvalidInput);
}

TEST(SmoothingFarAway, NoDetectorIsTooFineNearBy) {
  const Matrix6d fine = isotropic(0.01, 5e-6);
  EXPECT_NO_THROW(smoothed_at(SE3d(), 0, MotionModel::odometry, 0.0, false, fine));
}

}  // namespace
}  // namespace posemix
