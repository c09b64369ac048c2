// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The filter of one moving object with cameras and frames whose poses have errors.
#include <gtest/gtest.h>

#include "moving_object_scene.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::MovingScene;
using testing::nees_of;
using testing::plain_moving_settings;
using testing::SceneNoise;

using testing::kFramePeriod_s;

/// NEES of a still object in the world after many detections from cameras with errors.
double camera_nees(const Matrix6d& independent, const Matrix6d& constant, bool state_it) {
  const DetectorNoise noise = SceneNoise{.gross = 0.0}.noise();
  double nees = 0.0;
  constexpr int kSeeds = 150;
  for (int seed = 0; seed < kSeeds; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    const SE3d fixed = SE3d::exp(testing::draw(constant, scene.stream));
    MovingObjectFilter filter({noise}, {}, plain_moving_settings());
    for (int k = 0; k < 40; ++k) {
      scene.advance(StaticMotion{}, kFramePeriod_s);
      // The true camera is Exp(error) times the stated one.
      const SE3d stated =
          (SE3d::exp(testing::draw(independent, scene.stream)) * fixed).inverse() * scene.camera;
      KnownCamera camera{.frame = {.pose = stated, .covariance = independent}};
      if (state_it) camera.constant_covariance = constant;
      filter.update(scene.observed(scene.inlier()), camera);
    }
    nees += nees_of(scene.truth, filter.estimate().hypotheses.front().world) / 6.0 / kSeeds;
  }
  return nees;
}

TEST(MovingObjectCameras, DoesNotAverageAConstantErrorOfTheCameraAway) {
  const Matrix6d constant = isotropic(1.0, 0.01);
  EXPECT_NEAR(camera_nees(isotropic(1e-6, 1e-9), constant, true), 1.0, 0.15);
  EXPECT_GT(camera_nees(isotropic(1e-6, 1e-9), constant, false), 5.0);
}

TEST(MovingObjectCameras, AveragesIndependentErrorsOfACameraOnAnArm) {
  EXPECT_NEAR(camera_nees(isotropic(0.7, 0.01), isotropic(0.5, 0.005), true), 1.0, 0.15);
}

TEST(MovingObjectCameras, SeesTheObjectFromTheCameraWithoutItsConstantError) {
  MovingScene scene(3, SceneNoise{}.noise());
  MovingObjectFilter filter({SceneNoise{}.noise()}, {}, plain_moving_settings());
  const KnownCamera camera =
      still_camera(ConcentratedGaussian<SE3d>(scene.camera, isotropic(1.0, 0.01)));
  for (int k = 0; k < 30; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(scene.inlier()), camera);
  }
  const auto seen = filter.relative_mixture(camera);
  const auto world = filter.object_mixture();
  const auto& relative = seen[seen.heaviest()].density;
  EXPECT_TRUE(
      (scene.camera * relative.mean()).is_approx(world[world.heaviest()].density.mean(), 1e-12));
  const Matrix6d in_world = scene.camera.adjoint_congruence(relative.covariance());
  const Matrix6d expected = world[world.heaviest()].density.covariance();
  EXPECT_TRUE(testing::matrices_near(in_world + isotropic(1.0, 0.01), expected, 1e-12));
}

// What a frame errs in one image is not averaged away while it holds the object, and counts once
// when it lets go.
TEST(MovingObjectCameras, HasTheErrorOfTheFrameThatHoldsTheObject) {
  const Matrix6d of_frame = isotropic(0.5, 0.004);
  MovingScene scene(4, SceneNoise{.gross = 0.0}.noise());
  MovingObjectFilter filter({SceneNoise{.gross = 0.0}.noise()}, {.models = {AttachedMotion{}}},
                            plain_moving_settings());
  for (int k = 0; k < 200; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera),
                  {{.pose = SE3d(), .covariance = of_frame}});
  }
  const Matrix6d covariance = filter.estimate().hypotheses.front().world.covariance();
  for (Eigen::Index i = 0; i < 6; ++i) EXPECT_GT(covariance(i, i), of_frame(i, i));
  EXPECT_LT(covariance.trace(), 1.2 * of_frame.trace());
}

}  // namespace
}  // namespace posemix
