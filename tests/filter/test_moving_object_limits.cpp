// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The filter of one moving object at its limits: many places, no slow error, detections of nothing.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "moving_object_scene.hpp"

namespace posemix {
namespace {

using testing::kFramePeriod_s;
using testing::MovingScene;
using testing::plain_moving_settings;
using testing::pose;
using testing::SceneNoise;
using testing::sds;

// However many places the detector shows.
TEST(MovingObjectFilter, KeepsNoMoreHypothesesThanItMay) {
  const DetectorNoise noise = SceneNoise{.clutter = 0.3}.noise();
  MovingScene scene(12, noise);
  MovingObjectSettings settings = plain_moving_settings();
  settings.max_hypotheses = 2;
  MovingObjectFilter filter({noise}, {}, settings);
  std::uint64_t newest = 0;
  for (int k = 0; k < 12; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(k % 3 == 2 ? scene.anywhere() : scene.inlier()),
                  exact_camera(scene.camera));
    const MovingObjectEstimate estimate = filter.estimate();
    EXPECT_LE(estimate.hypotheses.size(), 2U) << k;
    double sum = estimate.lost_probability;
    for (const auto& hypothesis : estimate.hypotheses) {
      sum += hypothesis.probability;
      newest = std::max(newest, hypothesis.id);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12) << k;
  }
  EXPECT_GT(newest, 2U);
}

// Without a slow error a detection is expected where the object is, up to its white error.
TEST(MovingObjectFilter, ExpectsDetectionsOfADetectorWithoutASlowErrorAtTheObject) {
  const DetectorNoise noise = SceneNoise{}.noise();
  MovingScene scene(13, noise);
  const MotionModels models{.models = {StaticMotion{}, RandomWalkMotion{sds(0.1, 0.03)}},
                            .rates = (Eigen::MatrixXd(2, 2) << 0.0, 0.5, 0.5, 0.0).finished()};
  MovingObjectFilter filter({noise}, models, plain_moving_settings());
  KnownCamera camera = exact_camera(scene.camera);
  camera.frame.covariance = testing::isotropic(0.1, 0.001);
  for (int k = 0; k < 5; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(scene.inlier()), camera);
    const auto expected = filter.relative(camera);
    const auto detection = filter.predicted_detection(camera);
    EXPECT_TRUE(detection.mean().is_approx(expected.mean(), 1e-12));
    EXPECT_TRUE(detection.covariance().isApprox(expected.covariance(), 1e-9));
  }
}

// So far away that no component of the noise has any density there.
TEST(MovingObjectFilter, SaysThatADetectionFarAwayIsNotOfTheObject) {
  const DetectorNoise noise = SceneNoise{.flips = 0.1, .mode_time_s = 1.0}.noise();
  MovingScene scene(14, noise);
  MovingObjectFilter filter({noise}, {}, plain_moving_settings());
  for (int k = 0; k < 20; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
  }
  const SE3d far = scene.inlier() * pose(0.5, 1.5, 0.3, 0.3, 0.0, 0.0);
  const MovingObjectReport report = filter.update(scene.observed(far), exact_camera(scene.camera));
  EXPECT_GE(report.right_probability, 0.0);
  EXPECT_LT(report.right_probability, 1e-9);
  EXPECT_GE(report.inlier_probability, 0.0);
  EXPECT_LT(report.inlier_probability, 1e-9);
  EXPECT_TRUE(std::isfinite(report.log_evidence));
}

}  // namespace
}  // namespace posemix
