// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// An object that moves as its model says, at rates and with detectors at which it turns and moves
// by many standard deviations of the detector from one detection to the next.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "moving_object_scene.hpp"
#include "posemix/filter/moving_object_smoother.hpp"

namespace posemix {
namespace {

using testing::kFlipOfObject;
using testing::kFramePeriod_s;
using testing::MovingScene;
using testing::nees_of;
using testing::SceneNoise;
using testing::sds;

DetectorNoise sharp_noise() {
  const Matrix6d covariance =
      pose_covariance(Eigen::Vector3d::Constant(radians(2.0)), Eigen::Vector3d::Constant(1e-4));
  return DetectorNoise({{.weight = 0.85, .covariance = covariance, .frame = NoiseFrame::ray},
                        {.weight = 0.1, .covariance = 9.0 * covariance, .frame = NoiseFrame::ray}},
                       {.weight = 0.05, .volume_m3 = 1.0});
}

/// A scene whose object moves by a model, and whose camera moves along with it.
class Followed {
 public:
  Followed(std::uint64_t seed, const DetectorNoise& noise, const ConstantVelocityMotion& motion)
      : scene(seed, noise), motion_(motion) {
    Eigen::VectorXd white(6);
    scene.stream.fill_normal(white);
    scene.twist = 0.5 * white.cwiseProduct(motion.start_sds.cwiseMin(sds(0.4, 1.0)));
  }

  void advance(double dt) {
    const int parts = std::max(1, static_cast<int>(dt / 0.05));
    for (int k = 0; k < parts; ++k) scene.advance(motion_, dt / parts);
    const SE3d camera = testing::scene_camera();
    scene.camera = SE3d(camera.rotation(), camera.translation() + scene.truth.translation());
  }

  double turn_to(const SE3d& estimate) const {
    return (scene.truth.rotation() * estimate.rotation().inverse()).log().norm();
  }

  MovingScene scene;

 private:
  ConstantVelocityMotion motion_;
};

struct Rate {
  double rate_hz;
  double rotation;     ///< [rad / s^1.5]
  double translation;  ///< [m / s^1.5]
  DetectorNoise noise;
};

struct Accuracy {
  double nees = 0.0;    ///< per degree of freedom
  double within = 0.0;  ///< part of it below the 0.95 quantile
  std::vector<double> distances = {};
};

Accuracy accuracy(const Rate& rate, int seeds) {
  Accuracy result;
  const ConstantVelocityMotion motion{sds(rate.rotation, rate.translation)};
  for (int seed = 1; seed <= seeds; ++seed) {
    Followed followed(static_cast<std::uint64_t>(seed), rate.noise, motion);
    MovingScene& scene = followed.scene;
    MovingObjectFilter filter({rate.noise}, {.models = {motion}});
    for (int k = 0; k < 40; ++k) {
      followed.advance(1.0 / rate.rate_hz);
      filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
      if (k < 10) continue;
      const ConcentratedGaussian<SE3d> world = filter.estimate().hypotheses.front().world;
      const double nees = nees_of(scene.truth, world) / 6.0;
      result.nees += nees / 30.0 / seeds;
      result.within += (nees < 12.59 / 6.0) / 30.0 / seeds;
      result.distances.push_back((scene.truth.translation() - world.mean().translation()).norm());
    }
  }
  std::sort(result.distances.begin(), result.distances.end());
  return result;
}

// The errors of the pose are those of its tangent space after a correction, not before.
TEST(MovingObjectRates, TheCovarianceHoldsHoweverFarThePoseMovesBetweenDetections) {
  const DetectorNoise usual = SceneNoise{}.noise();
  for (const Rate& rate : {Rate{1.0, 0.02, 1.0, usual}, Rate{1.0, 0.1, 0.3, usual},
                           Rate{2.0, 0.02, 1.0, usual}, Rate{10.0, 0.1, 0.3, usual},
                           Rate{100.0, 0.1, 0.3, usual}, Rate{10.0, 1.0, 1.0, sharp_noise()}}) {
    const Accuracy found = accuracy(rate, 10);
    EXPECT_GT(found.nees, 0.5) << rate.rate_hz;
    EXPECT_LT(found.nees, 1.3) << rate.rate_hz;
    EXPECT_GT(found.within, 0.85) << rate.rate_hz;
    const Matrix6d& detection = rate.noise.components().front().covariance;
    EXPECT_LT(found.distances[found.distances.size() / 2],
              std::sqrt(detection.bottomRightCorner<3, 3>().trace()))
        << rate.rate_hz;
  }
}

// A detection each second, with the default motion: the object may be metres from where it is
// expected, and the hypothesis that the detector is wrong is one of its own.
TEST(MovingObjectRates, ADetectionIsBelievedWhereThePredictionIsWide) {
  const Accuracy found = accuracy({1.0, 1.0, 1.0, SceneNoise{}.noise()}, 10);
  EXPECT_LT(found.nees, 1.3);
  EXPECT_LT(found.distances[found.distances.size() / 2], 0.01);
  EXPECT_LT(found.distances[found.distances.size() * 95 / 100], 0.03);
}

TEST(MovingObjectRates, TheSmootherIsNoWorseThanItsFilter) {
  const DetectorNoise noise = SceneNoise{}.noise();
  const ConstantVelocityMotion motion{sds(0.1, 0.3)};
  double of_filter = 0.0;
  double of_smoother = 0.0;
  double nees = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Followed followed(seed, noise, motion);
    MovingScene& scene = followed.scene;
    MovingObjectSmoother smoother({noise}, {.models = {motion}});
    std::vector<SE3d> truth;
    for (int k = 0; k < 30; ++k) {
      followed.advance(1.0);
      smoother.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
      truth.push_back(scene.truth);
      if (k < 5) continue;
      const ConcentratedGaussian<SE3d> world =
          smoother.filter().estimate().hypotheses.front().world;
      of_filter += (truth.back().translation() - world.mean().translation()).squaredNorm();
    }
    const std::vector<MovingObjectEstimate> smoothed = smoother.smoothed();
    for (std::size_t k = 5; k < truth.size(); ++k) {
      const auto& world = smoothed[k].hypotheses.front().world;
      of_smoother += (truth[k].translation() - world.mean().translation()).squaredNorm();
      nees += nees_of(truth[k], world) / 6.0 / 25.0 / 5.0;
    }
  }
  EXPECT_LT(of_smoother, 1.05 * of_filter);
  EXPECT_GT(nees, 0.4);
  EXPECT_LT(nees, 1.3);
}

/// Part of seeds in which the most probable hypothesis is turned at the fifth detection after a
/// gap, and what the filter says of it.
template <class Show>
std::pair<double, double> turned_after_a_gap(const DetectorNoise& noise, double gap_s,
                                             const Show& show) {
  constexpr int kSeeds = 40;
  const ConstantVelocityMotion motion{sds(0.1, 0.3)};
  std::pair<double, double> result;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Followed followed(static_cast<std::uint64_t>(seed), noise, motion);
    MovingScene& scene = followed.scene;
    MovingObjectFilter filter({noise}, {.models = {motion}});
    for (int k = 0; k < 35; ++k) {
      followed.advance(k == 30 ? gap_s : kFramePeriod_s);
      filter.update(show(scene), exact_camera(scene.camera));
    }
    const MovingObjectEstimate now = filter.estimate();
    const SE3d& leader = now.hypotheses.front().world.mean();
    result.first += (followed.turn_to(leader) > 1.57) / static_cast<double>(kSeeds);
    for (const auto& hypothesis : now.hypotheses)
      if ((leader.rotation() * hypothesis.world.mean().rotation().inverse()).log().norm() > 1.57)
        result.second += hypothesis.probability / kSeeds;
  }
  return result;
}

// Right detections do not make the hypothesis that they agree with wide, nor the turned one sharp.
TEST(MovingObjectRates, ATurnedDetectionIsSeenThroughAfterAGap) {
  for (const double gap_s : {3.0, 5.0}) {
    const auto [turned, said] =
        turned_after_a_gap(SceneNoise{.flips = 0.2}.noise(), gap_s,
                           [](MovingScene& scene) { return scene.observed(scene.detect()); });
    EXPECT_LE(turned, 0.05) << gap_s;
    EXPECT_LT(said, 0.1) << gap_s;
  }
}

TEST(MovingObjectRates, TwoPosesOfAnObservationAreTwoHypothesesAfterAGap) {
  for (const double gap_s : {3.0, 5.0}) {
    const auto [turned, said] =
        turned_after_a_gap(SceneNoise{}.noise(), gap_s, [](MovingScene& scene) {
          const SE3d seen = scene.inlier();
          const double right = scene.stream.uniform() < 0.85 ? 0.85 : 0.15;
          Observation observation = scene.observed(seen);
          observation.components = {{.weight = right, .pose = seen},
                                    {.weight = 1.0 - right, .pose = seen * kFlipOfObject}};
          return observation;
        });
    EXPECT_LE(turned, 0.05) << gap_s;
    EXPECT_LT(said, 0.1) << gap_s;
  }
}

TEST(MovingObjectRates, FactorsOnTheNoiseAreNumbers) {
  for (const double bad : {std::nan(""), -1.0, 1e7, std::numeric_limits<double>::infinity()}) {
    ObjectSensor sensor{SceneNoise{}.noise()};
    sensor.noise_scale[1] = bad;
    EXPECT_THROW(MovingObjectFilter(sensor, {.models = {StaticMotion{}}}), InvalidInput);
    sensor.noise_scale.setOnes();
    sensor.slow_scale[4] = bad;
    EXPECT_THROW(MovingObjectFilter(sensor, {.models = {StaticMotion{}}}), InvalidInput);
  }
}

// An object that lies still, and a detector without noise: there is nothing to learn later.
TEST(MovingObjectRates, WhatIsKnownIsSmoothed) {
  ObjectSensor sensor{SceneNoise{}.noise()};
  sensor.noise_scale.setZero();
  MovingScene scene(1, sensor.noise);
  const SE3d seen = scene.camera.inverse() * scene.truth;
  MovingObjectSmoother smoother(sensor, {.models = {StaticMotion{}}});
  for (int k = 0; k < 5; ++k) {
    smoother.update(scene.observed(seen), exact_camera(scene.camera));
    scene.time_s += kFramePeriod_s;
  }
  const SE3d found = smoother.smoothed().front().hypotheses.front().world.mean();
  EXPECT_LT((found.inverse() * scene.truth).log().norm(), 1e-9);
}

// Every detection shows one of two equivalent poses, which are one place.
TEST(MovingObjectRates, EquivalentPosesAreOnePlaceAfterAGap) {
  const DetectorNoise noise = SceneNoise{}.noise();
  const ConstantVelocityMotion motion{sds(0.1, 0.3)};
  const SymmetryGroup symmetries({kFlipOfObject}, {});
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Followed followed(seed, noise, motion);
    MovingScene& scene = followed.scene;
    MovingObjectFilter filter({.noise = noise, .symmetries = symmetries}, {.models = {motion}});
    for (int k = 0; k < 40; ++k) {
      followed.advance(k == 30 ? 5.0 : kFramePeriod_s);
      const SE3d seen = scene.inlier();
      const bool is_turned = scene.stream.uniform() < 0.5;
      filter.update(scene.observed(is_turned ? seen * kFlipOfObject : seen),
                    exact_camera(scene.camera));
    }
    const MovingObjectEstimate now = filter.estimate();
    EXPECT_GT(now.hypotheses.front().probability, 0.75) << seed;
    const SE3d near =
        symmetries.closest(now.hypotheses.front().world.mean(), scene.truth, Matrix6d::Identity());
    EXPECT_LT((near.translation() - scene.truth.translation()).norm(), 0.03) << seed;
    EXPECT_LT(followed.turn_to(near), 0.3) << seed;
  }
}

// A detector that is never wrong alone, and stays in its mode, shows two places at one time.
TEST(MovingObjectRates, WhatIsImpossibleByAllThatIsStatedTellsNothing) {
  const DetectorNoise noise = SceneNoise{.mode_time_s = 1.0}.noise();
  MovingObjectSettings settings;
  settings.isolated_clutter = 0.0;
  MovingScene scene(1, noise);
  MovingObjectFilter filter({noise}, {.models = {ConstantVelocityMotion{}}}, settings);
  for (int k = 0; k < 5; ++k) {
    scene.time_s += kFramePeriod_s;
    filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
  }
  const double probability = filter.estimate().hypotheses.front().probability;
  const SE3d elsewhere = scene.camera.inverse() * testing::pose(1, 0, 0, 0.5, 0.3, 0) * scene.truth;
  const MovingObjectReport report =
      filter.update(scene.observed(elsewhere), exact_camera(scene.camera));
  EXPECT_TRUE(std::isfinite(report.log_evidence));
  EXPECT_NEAR(filter.estimate().hypotheses.front().probability, probability, 1e-9);
  scene.time_s += kFramePeriod_s;
  filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
  EXPECT_GT(filter.estimate().hypotheses.front().probability, 0.9);
}

}  // namespace
}  // namespace posemix
