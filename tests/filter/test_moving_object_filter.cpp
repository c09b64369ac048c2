// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The filter of one moving object in simulation: consistency, the probability of models, cameras.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "moving_object_scene.hpp"
#include "posemix/detector/default_noise.hpp"

namespace posemix {
namespace {

using testing::MovingScene;
using testing::nees_of;
using testing::plain_moving_settings;
using testing::pose;
using testing::SceneNoise;
using testing::sds;

using testing::kFramePeriod_s;

struct Consistency {
  double nees = 0.0;  ///< of the pose, per degree of freedom
  double nis = 0.0;
  double least_probability = 1.0;
};

/// Means over seeds and frames, from the tenth detection on, of an object that moves by a model
/// that the filter knows.
Consistency consistency(const ObjectMotion& motion, const DetectorNoise& noise, int seeds,
                        int frames) {
  Consistency result;
  double count = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    if (const auto* velocity = std::get_if<ConstantVelocityMotion>(&motion))
      scene.twist = testing::draw(velocity->start_sds.cwiseAbs2().asDiagonal(), scene.stream);
    MovingObjectFilter filter({noise}, {.models = {motion}}, plain_moving_settings());
    SE3d frame;
    for (int k = 0; k < frames; ++k) {
      SE3d frame_motion;
      if (std::holds_alternative<AttachedMotion>(motion)) {
        const SE3d next = pose(0.3 * std::sin(0.2 * k), 0.1, 0.05 * k, 0.05 * std::cos(0.3 * k),
                               0.02 * std::sin(0.1 * k), 0);
        frame_motion = k == 0 ? SE3d() : next * frame.inverse();
        frame = next;
      }
      if (k > 0) scene.advance(motion, kFramePeriod_s, frame_motion);
      const MovingObjectReport report =
          filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera), {{frame}});
      if (k < 10) continue;
      const MovingObjectEstimate estimate = filter.estimate();
      result.nees += nees_of(scene.truth, estimate.hypotheses.front().world) / 6.0;
      result.nis += *report.nis / 6.0;
      result.least_probability =
          std::min(result.least_probability, estimate.hypotheses.front().probability);
      count += 1.0;
    }
  }
  result.nees /= count;
  result.nis /= count;
  return result;
}

std::vector<ObjectMotion> moving_models() {
  return {StaticMotion{},
          PutDownMotion{},
          RandomWalkMotion{sds(0.1, 0.03), MotionFrame::object},
          RandomWalkMotion{sds(0.1, 0.03), MotionFrame::world},
          ConstantVelocityMotion{sds(0.5, 0.1), MotionFrame::object, sds(0.5, 0.1)},
          ConstantVelocityMotion{sds(0.5, 0.1), MotionFrame::world, sds(0.5, 0.1)},
          AttachedMotion{.slip_sds = sds(0.02, 0.005)}};
}

// 40 seeds of 50 frames: errors of one path are correlated; the band is the one that is promised.
TEST(MovingObjectFilter, IsConsistentOnTheRightModel) {
  const DetectorNoise noise = SceneNoise{.gross = 0.0}.noise();
  for (const ObjectMotion& motion : moving_models()) {
    const Consistency result = consistency(motion, noise, 40, 60);
    const std::string name(name_of(motion));
    RecordProperty(name, fmt::format("NEES {:.3f}, NIS {:.3f}", result.nees, result.nis));
    EXPECT_GT(result.nees, 0.8) << name;
    EXPECT_LT(result.nees, 1.25) << name;
    EXPECT_GT(result.nis, 0.9) << name;
    EXPECT_LT(result.nis, 1.1) << name;
    EXPECT_GT(result.least_probability, 0.99) << name;
  }
}

/// Still, then moving, then still again: the mean probability of the right model, and the NEES.
TEST(MovingObjectFilter, FindsTheModel) {
  const DetectorNoise noise = SceneNoise{.gross = 0.0}.noise();
  const ConstantVelocityMotion moving{sds(0.5, 0.1), MotionFrame::object, sds(1.0, 0.2)};
  const MotionModels models{.models = {PutDownMotion{}, moving},
                            .rates = (Eigen::MatrixXd(2, 2) << 0.0, 0.2, 0.3, 0.0).finished(),
                            .start = {0.8, 0.2}};
  double still = 0.0;
  double moved = 0.0;
  double nees = 0.0;
  double count = 0.0;
  constexpr int kSeeds = 60;
  for (int seed = 0; seed < kSeeds; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    MovingObjectFilter filter({noise}, models, plain_moving_settings());
    for (int k = 0; k < 90; ++k) {
      const bool moves = k >= 30 && k < 60;
      if (k == 30)
        scene.twist = testing::draw(moving.start_sds.cwiseAbs2().asDiagonal(), scene.stream);
      if (k == 60) scene.twist.setZero();
      scene.advance(moves ? ObjectMotion(moving) : ObjectMotion(StaticMotion{}), kFramePeriod_s);
      filter.update(scene.observed(scene.detect()), exact_camera(scene.camera));
      const MovingObjectEstimate estimate = filter.estimate();
      if (k == 29) still += estimate.models[0] / (2 * kSeeds);
      if (k == 50) moved += estimate.models[1] / kSeeds;
      if (k == 89) still += estimate.models[0] / (2 * kSeeds);
      if (k < 10) continue;
      nees += nees_of(scene.truth, estimate.hypotheses.front().world) / 6.0;
      count += 1.0;
    }
  }
  RecordProperty("still", fmt::format("{:.3f}", still));
  RecordProperty("moved", fmt::format("{:.3f}", moved));
  RecordProperty("nees", fmt::format("{:.3f}", nees / count));
  EXPECT_GT(still, 0.9);
  EXPECT_GT(moved, 0.95);
  EXPECT_GT(nees / count, 0.8);
  EXPECT_LT(nees / count, 1.25);
}

TEST(MovingObjectFilter, PredictsWithoutAChange) {
  const DetectorNoise noise = SceneNoise{}.noise();
  const ConstantVelocityMotion motion{sds(0.3, 0.05), MotionFrame::object, sds(0.5, 0.2)};
  double nees = 0.0;
  constexpr int kSeeds = 200;
  for (int seed = 0; seed < kSeeds; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    scene.twist = testing::draw(motion.start_sds.cwiseAbs2().asDiagonal(), scene.stream);
    MovingObjectFilter filter({noise}, {.models = {motion}}, plain_moving_settings());
    for (int k = 0; k < 15; ++k) {
      scene.advance(motion, kFramePeriod_s);
      filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
    }
    const SE3d before = filter.estimate().hypotheses.front().world.mean();
    const MovingObjectEstimate later = filter.estimate_at(scene.time_s + 0.2);
    const auto mixture = filter.predict_to(scene.time_s + 0.2);
    EXPECT_EQ(mixture[mixture.heaviest()].density.mean().matrix(),
              later.hypotheses.front().world.mean().matrix());
    EXPECT_EQ(filter.estimate().hypotheses.front().world.mean().matrix(), before.matrix());
    EXPECT_EQ(*filter.time_s(), scene.time_s);
    scene.advance(motion, 0.2);
    nees += nees_of(scene.truth, later.hypotheses.front().world) / 6.0 / kSeeds;
    // The same as a prediction of the filter itself.
    filter.predict(scene.time_s);
    EXPECT_EQ(filter.estimate().hypotheses.front().world.covariance(),
              later.hypotheses.front().world.covariance());
  }
  EXPECT_GT(nees, 0.8);
  EXPECT_LT(nees, 1.25);
}

TEST(MovingObjectFilter, KeepsTheSlowErrorOfTheDetector) {
  NoiseDependence dependence;
  dependence.slow = SlowError{.covariance = 4.0 * SceneNoise::inlier(), .correlation_time_s = 5.0};
  const DetectorNoise noise(
      {{.weight = 0.95, .covariance = SceneNoise::inlier(), .frame = NoiseFrame::ray}},
      {.weight = 0.05, .volume_m3 = 1.0}, dependence);
  double nees = 0.0;
  double count = 0.0;
  for (int seed = 0; seed < 60; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    MovingObjectFilter filter({noise}, {.models = {RandomWalkMotion{sds(0.02, 0.005)}}},
                              plain_moving_settings());
    const double a = std::exp(-kFramePeriod_s / 5.0);
    Vector6d slow = testing::draw(dependence.slow->covariance, scene.stream);
    for (int k = 0; k < 100; ++k) {
      scene.advance(RandomWalkMotion{sds(0.02, 0.005)}, kFramePeriod_s);
      slow = (a * slow +
              std::sqrt(1 - a * a) * testing::draw(dependence.slow->covariance, scene.stream))
                 .eval();
      const SE3d mode = scene.camera.inverse() * scene.truth;
      const NoiseAtPose at = noise_at(noise.components().front(), mode);
      const Vector6d error =
          at.units.cwiseProduct(slow) + testing::draw(at.covariance, scene.stream);
      filter.update(scene.observed(at.axes * SE3d::exp(error) * at.axes.inverse() * mode),
                    exact_camera(scene.camera));
      if (k < 10) continue;
      nees += nees_of(scene.truth, filter.estimate().hypotheses.front().world) / 6.0;
      count += 1.0;
    }
  }
  EXPECT_GT(nees / count, 0.8);
  EXPECT_LT(nees / count, 1.25);
}

TEST(MovingObjectFilter, LeavesTheAngleAboutAnAxisOfSymmetryFree) {
  const DetectorNoise noise = SceneNoise{}.noise();
  const SymmetryGroup symmetries({}, {SymmetryAxis{}});
  MovingScene scene(6, noise);
  scene.twist << 0.1, 0.2, 3.0, 0.1, 0.0, 0.05;
  const ConstantVelocityMotion motion{sds(0.3, 0.05), MotionFrame::object, sds(1.0, 0.3)};
  MovingObjectFilter filter({noise, symmetries}, {.models = {motion}}, plain_moving_settings());
  for (int k = 0; k < 80; ++k) {
    scene.advance(ConstantVelocityMotion{sds(0, 0)}, kFramePeriod_s);
    const SE3d any_angle(SO3d::exp({0.0, 0.0, 6.3 * scene.stream.uniform()}), {0, 0, 0});
    filter.update(scene.observed(scene.inlier() * any_angle), exact_camera(scene.camera));
  }
  const MovingObjectEstimate estimate = filter.estimate();
  const auto& world = estimate.hypotheses.front().world;
  EXPECT_GT(estimate.hypotheses.front().probability, 0.99);
  const SE3d truth = symmetries.nearest_rotation(scene.truth, world.mean());
  EXPECT_LT((truth.rotation().inverse() * world.mean().rotation()).angle(), radians(4.0));
  EXPECT_LT((truth.translation() - world.mean().translation()).norm(), 0.02);
  const Matrix6d local = world.mean().inverse().adjoint_congruence(world.covariance());
  EXPECT_NEAR(std::sqrt(local(2, 2)), 1.81, 0.1);
}

TEST(MovingObjectFilter, BeginsWithEveryComponentOfAnObservation) {
  MovingScene scene(7, SceneNoise{}.noise());
  MovingObjectFilter filter({SceneNoise{}.noise()}, {}, plain_moving_settings());
  const SE3d seen = scene.camera.inverse() * scene.truth;
  Observation observation = scene.observed(seen);
  observation.components = {{.weight = 0.7, .pose = seen},
                            {.weight = 0.3, .pose = seen * testing::kFlipOfObject}};
  EXPECT_TRUE(filter.update(observation, exact_camera(scene.camera)).started);
  const MovingObjectEstimate estimate = filter.estimate();
  ASSERT_EQ(estimate.hypotheses.size(), 2U);
  EXPECT_NEAR(estimate.hypotheses[0].probability / estimate.hypotheses[1].probability, 7.0 / 3.0,
              1e-9);
  EXPECT_NEAR(estimate.lost_probability, 0.05, 1e-9);
  double sum = estimate.lost_probability;
  for (const auto& hypothesis : estimate.hypotheses) sum += hypothesis.probability;
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

TEST(MovingObjectFilter, HasNoPlaceOfAnObjectThatWasNotSeen) {
  using testing::thrown_message;
  const MovingObjectFilter filter({SceneNoise{}.noise()});
  EXPECT_EQ(thrown_message([&] { filter.estimate(); }), "estimate: there was no observation yet");
  const std::string unknown = ": the place of the object is not known";
  EXPECT_EQ(thrown_message([&] { filter.object_mixture(); }), "object_mixture" + unknown);
  EXPECT_EQ(thrown_message([&] { filter.relative_mixture({}); }), "relative_mixture" + unknown);
  EXPECT_EQ(thrown_message([&] { filter.relative({}); }), "relative" + unknown);
  EXPECT_EQ(thrown_message([&] { filter.predicted_detection({}); }),
            "predicted_detection" + unknown);
}

TEST(MovingObjectFilter, RefusesWhatItCannotUseAndStaysAsItWas) {
  using testing::thrown_message;
  const ObjectSensor sensor{SceneNoise{}.noise()};
  EXPECT_NE(thrown_message([&] { MovingObjectFilter(sensor, {.models = {}}); }), "");
  EXPECT_NE(
      thrown_message([&] { MovingObjectFilter(sensor, {.rates = Eigen::MatrixXd::Zero(2, 2)}); }),
      "");
  EXPECT_NE(thrown_message([&] {
              MovingObjectFilter(sensor, {.models = {StaticMotion{}, PutDownMotion{}},
                                          .rates = Eigen::MatrixXd::Constant(2, 2, -1.0)});
            }),
            "");
  EXPECT_NE(thrown_message([&] { MovingObjectFilter(sensor, {.start = {0.4}}); }), "");
  EXPECT_NE(thrown_message([&] { MovingObjectFilter(sensor, {}, {.max_hypotheses = 0}); }), "");
  EXPECT_NE(thrown_message([&] { MovingObjectFilter(sensor, {}, {.turned_clutter = 1.0}); }), "");
  ObjectSensor two = sensor;
  two.other_detectors = {sensor.noise};
  EXPECT_NE(thrown_message([&] { MovingObjectFilter{two}; }), "");

  MovingObjectFilter filter(sensor, {.models = {StaticMotion{}, AttachedMotion{}}});
  MovingScene scene(8, sensor.noise);
  const KnownCamera camera = exact_camera(scene.camera);
  EXPECT_NE(thrown_message([&] { filter.update(scene.observed(scene.inlier()), camera); }), "");
  filter.update(scene.observed(scene.inlier()), camera, {{SE3d()}});
  const SE3d before = filter.estimate().hypotheses.front().world.mean();
  Observation late = scene.observed(scene.inlier());
  late.stamp_s = -1.0;
  EXPECT_EQ(thrown_message([&] { filter.update(late, camera, {{SE3d()}}); }),
            "the time is -1 s, expected 0 s or later");
  EXPECT_NE(thrown_message([&] { filter.predict(std::nan("")); }), "");
  EXPECT_NE(thrown_message([&] { filter.estimate_at(-2.0); }), "");
  KnownCamera broken = camera;
  broken.frame.covariance(0, 0) = -1.0;
  EXPECT_NE(
      thrown_message([&] { filter.update(scene.observed(scene.inlier()), broken, {{SE3d()}}); }),
      "");
  Observation empty;
  EXPECT_NE(thrown_message([&] { filter.update(empty, camera, {{SE3d()}}); }), "");
  EXPECT_EQ(filter.observation_count(), 1U);
  EXPECT_EQ(filter.estimate().hypotheses.front().world.mean().matrix(), before.matrix());
}

}  // namespace
}  // namespace posemix
