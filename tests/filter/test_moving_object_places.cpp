// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// What is known of the place of an object that moves: whether it is at one of the hypotheses, with
// an axis of symmetry, and with fewer hypotheses than there are places.
#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "moving_object_scene.hpp"
#include "posemix/detector/default_noise.hpp"

namespace posemix {
namespace {

using testing::kFramePeriod_s;
using testing::MovingScene;
using testing::nees_of;
using testing::pose;
using testing::scene_camera;
using testing::SceneNoise;
using testing::sds;

/// The camera goes along with the object.
void follow(MovingScene& scene) {
  const SE3d camera = scene_camera();
  scene.camera = SE3d(camera.rotation(), camera.translation() + scene.truth.translation());
}

/// Detections that are all right are as probable where the object is as in a run of wrong ones that
/// begins there, so that the probability of the latter changes with nothing but time: it is that of
/// a run at the first detection, and was a random walk up to one where hypotheses were split.
TEST(MovingObjectPlaces, AreNotLostWhereDetectionsAreRight) {
  const DetectorNoise noise = default_detector_noise();
  const MotionModels models = calm_and_agile(ConstantVelocityMotion{sds(0.37, 0.39)});
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    MovingScene scene(seed, noise);
    MovingObjectFilter filter({noise}, models);
    double most = 0.0;
    for (int k = 0; k < 400; ++k) {
      scene.advance(models.models.front(), kFramePeriod_s);
      follow(scene);
      filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
      if (k > 1) most = std::max(most, filter.estimate().lost_probability);
    }
    EXPECT_LT(most, 0.2) << "seed " << seed;
    EXPECT_GT(filter.estimate().lost_probability, 0.02) << "seed " << seed;
  }
}

class SymmetricMotion : public ::testing::TestWithParam<ConstantVelocityMotion> {};

/// The spin about an axis of symmetry is seen by nothing, and turns the velocity that goes with the
/// object: the filter was sure that there was none.
TEST_P(SymmetricMotion, OfUnknownSpinIsFollowed) {
  const SymmetryGroup symmetries({}, {SymmetryAxis{}});
  const DetectorNoise noise = SceneNoise{}.noise();
  const ConstantVelocityMotion motion = GetParam();
  double sum = 0.0;
  double farthest = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    MovingScene scene(seed, noise);
    Eigen::VectorXd start(6);
    scene.stream.fill_normal(start);
    scene.twist = start.cwiseProduct(motion.start_sds);
    MovingObjectFilter filter({.noise = noise, .symmetries = symmetries}, {.models = {motion}});
    for (int k = 0; k < 60; ++k) {
      for (int part = 0; part < 2; ++part) scene.advance(motion, 0.5 * kFramePeriod_s);
      follow(scene);
      const SE3d turned = pose(0, 0, 2.0 * std::numbers::pi * scene.stream.uniform(), 0, 0, 0);
      filter.update(scene.observed(scene.inlier() * turned), exact_camera(scene.camera));
      if (k < 10) continue;
      const ConcentratedGaussian<SE3d> world = filter.estimate().hypotheses.front().world;
      const SE3d truth =
          symmetries.closest_observed(scene.truth, world.mean(), Matrix6d::Identity());
      sum += nees_of(truth, world) / 5.0;
      farthest =
          std::max(farthest, (world.mean().translation() - scene.truth.translation()).norm());
      ++count;
    }
  }
  EXPECT_GT(sum / count, 0.75);
  EXPECT_LT(sum / count, 1.25);
  EXPECT_LT(farthest, 0.1);
}

INSTANTIATE_TEST_SUITE_P(
    Default, SymmetricMotion,
    ::testing::Values(ConstantVelocityMotion{}, ConstantVelocityMotion{.frame = MotionFrame::world},
                      ConstantVelocityMotion{.acceleration_sds = sds(0.1, 0.3)},
                      ConstantVelocityMotion{.acceleration_sds = sds(0.1, 0.3),
                                             .frame = MotionFrame::world}));

/// A report is of the hypothesis that leads, and of one that was just begun nothing was expected.
TEST(MovingObjectPlaces, ThatJustBeganAreNotDescribed) {
  const DetectorNoise noise = SceneNoise{}.noise();
  const ConstantVelocityMotion motion;
  int begun = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    MovingScene scene(seed, noise);
    MovingObjectFilter filter({noise}, {.models = {motion}});
    for (int k = 0; k < 40; ++k) {
      for (int part = 0; part < 20; ++part) scene.advance(motion, 0.05);
      follow(scene);
      const MovingObjectReport report =
          filter.update(scene.observed(scene.detect()), exact_camera(scene.camera));
      const MovingObjectHypothesis leads = filter.estimate().hypotheses.front();
      EXPECT_EQ(report.nis.has_value(), leads.detections > 1);
      if (leads.detections > 1) continue;
      EXPECT_EQ(report.right_probability, 0.0);
      begun += k > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(begun, 0);
}

/// Of two places one is kept, and the probability of the other is not its own.
TEST(MovingObjectPlaces, ThatAreDroppedAreNotKnown) {
  const DetectorNoise noise = SceneNoise{}.noise();
  MovingObjectSettings settings = testing::plain_moving_settings();
  settings.max_hypotheses = 1;
  MovingScene scene(3, noise);
  follow(scene);
  MovingObjectFilter filter({noise}, {.models = {ConstantVelocityMotion{}}}, settings);
  Observation both = scene.observed(scene.inlier());
  both.components.front().weight = 0.6;
  both.components.push_back(both.components.front());
  both.components.back().weight = 0.4;
  both.components.back().pose = pose(0, 0, 0, 0.3, 0, 0) * both.components.back().pose;
  filter.update(both, exact_camera(scene.camera));
  const MovingObjectEstimate estimate = filter.estimate();
  ASSERT_EQ(estimate.hypotheses.size(), 1u);
  EXPECT_LT(estimate.hypotheses.front().probability, 0.65);
  EXPECT_GT(estimate.lost_probability, 0.35);
}

}  // namespace
}  // namespace posemix
