// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The smoother of one moving object in simulation: consistency, and errors below the filter's.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "moving_object_scene.hpp"
#include "posemix/filter/moving_object_smoother.hpp"

namespace posemix {
namespace {

using testing::MovingScene;
using testing::nees_of;
using testing::plain_moving_settings;
using testing::pose;
using testing::SceneNoise;
using testing::sds;

using testing::kFramePeriod_s;

/// Of the truth at the steps of a recording: NEES per degree of freedom, and squared errors of
/// rotation and position.
struct Errors {
  double nees = 0.0;
  double rotation = 0.0;
  double position = 0.0;
  double count = 0.0;

  void add(const SE3d& truth, const MovingObjectEstimate& estimate) {
    const auto& world = estimate.hypotheses.front().world;
    nees += nees_of(truth, world) / 6.0;
    const double angle = (truth.rotation().inverse() * world.mean().rotation()).angle();
    rotation += angle * angle;
    position += (truth.translation() - world.mean().translation()).squaredNorm();
    count += 1.0;
  }
};

struct Compared {
  Errors filtered;
  Errors smoothed;
};

/// A recording of a scene.
struct Recording {
  std::vector<MovingObjectStep> steps;
  std::vector<SE3d> truth;

  void add(const MovingScene& scene, const SE3d& seen, const SE3d& frame = {}) {
    steps.push_back({.observation = scene.observed(seen),
                     .camera = exact_camera(scene.camera),
                     .frames = {{.pose = frame}}});
    truth.push_back(scene.truth);
  }
  void compare(const ObjectSensor& sensor, const MotionModels& models, Compared& result) const {
    const MovingObjectSmoothing smoothing =
        smooth_moving_object(sensor, models, plain_moving_settings(), steps);
    for (std::size_t k = 10; k + 10 < steps.size(); ++k) {
      result.filtered.add(truth[k], smoothing.filtered[k]);
      result.smoothed.add(truth[k], smoothing.estimates[k]);
    }
  }
};

Compared compared(const ObjectMotion& motion, int seeds, int frames) {
  const DetectorNoise noise = SceneNoise{.gross = 0.0}.noise();
  Compared result;
  for (int seed = 0; seed < seeds; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    if (const auto* velocity = std::get_if<ConstantVelocityMotion>(&motion))
      scene.twist = testing::draw(velocity->start_sds.cwiseAbs2().asDiagonal(), scene.stream);
    Recording recording;
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
      recording.add(scene, scene.inlier(), frame);
    }
    recording.compare({noise}, {.models = {motion}}, result);
  }
  return result;
}

void expect_better(const Compared& result, const std::string& name, double most) {
  const double nees = result.smoothed.nees / result.smoothed.count;
  const double rotation = std::sqrt(result.smoothed.rotation / result.filtered.rotation);
  const double position = std::sqrt(result.smoothed.position / result.filtered.position);
  ::testing::Test::RecordProperty(
      name, fmt::format("NEES {:.3f}, of the filter's errors: rotation {:.3f}, position {:.3f}",
                        nees, rotation, position));
  EXPECT_GT(nees, 0.8) << name;
  EXPECT_LT(nees, 1.25) << name;
  EXPECT_LT(rotation, most) << name;
  EXPECT_LT(position, most) << name;
}

TEST(MovingObjectSmoother, IsConsistentAndBetterThanTheFilterOnTheRightModel) {
  // A random walk of the size of the noise leaves less to be gained.
  const std::vector<std::pair<const char*, ObjectMotion>> models = {
      {"static", StaticMotion{}},
      {"put_down", PutDownMotion{}},
      {"random_walk", RandomWalkMotion{sds(0.1, 0.03), MotionFrame::object}},
      {"random_walk_world", RandomWalkMotion{sds(0.1, 0.03), MotionFrame::world}},
      {"velocity", ConstantVelocityMotion{sds(0.5, 0.1), MotionFrame::object, sds(0.5, 0.1)}},
      {"velocity_world", ConstantVelocityMotion{sds(0.5, 0.1), MotionFrame::world, sds(0.5, 0.1)}},
      {"attached", AttachedMotion{.slip_sds = sds(0.02, 0.005)}}};
  for (const auto& [name, motion] : models) {
    const bool walks = std::holds_alternative<RandomWalkMotion>(motion);
    expect_better(compared(motion, 20, 60), name, walks ? 0.95 : 0.85);
  }
}

// Still, then moving, then still again, with gross errors and clutter.
TEST(MovingObjectSmoother, IsConsistentWhereTheModelChanges) {
  const DetectorNoise noise = SceneNoise{}.noise();
  const ConstantVelocityMotion moving{sds(0.5, 0.1), MotionFrame::object, sds(1.0, 0.2)};
  const MotionModels models{.models = {PutDownMotion{}, moving},
                            .rates = (Eigen::MatrixXd(2, 2) << 0.0, 0.2, 0.3, 0.0).finished(),
                            .start = {0.8, 0.2}};
  Compared result;
  for (int seed = 0; seed < 40; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    Recording recording;
    for (int k = 0; k < 90; ++k) {
      const bool moves = k >= 30 && k < 60;
      if (k == 30)
        scene.twist = testing::draw(moving.start_sds.cwiseAbs2().asDiagonal(), scene.stream);
      if (k == 60) scene.twist.setZero();
      scene.advance(moves ? ObjectMotion(moving) : ObjectMotion(StaticMotion{}), kFramePeriod_s);
      recording.add(scene, scene.detect());
    }
    recording.compare({noise}, models, result);
  }
  expect_better(result, "changes", 0.85);
}

// The path of an object that is put down elsewhere has a step at the jump, and no ramp. Just before
// it the object may have been gone already, while the detector was wrong.
TEST(MovingObjectSmoother, HasAStepWhereTheObjectIsPutDown) {
  const DetectorNoise noise = SceneNoise{.gross = 0.0, .clutter = 0.02, .mode_time_s = 1.0}.noise();
  int right = 0;
  int count = 0;
  for (int seed = 0; seed < 40; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    Recording recording;
    for (int k = 0; k < 40; ++k) {
      if (k == 20) scene.put_down();
      scene.advance(StaticMotion{}, kFramePeriod_s);
      recording.add(scene, scene.inlier());
    }
    const auto smoothed = smooth_moving_object({noise}, {.models = {PutDownMotion{}}},
                                               plain_moving_settings(), recording.steps);
    for (std::size_t k = 0; k < 40; ++k) {
      const auto& first = smoothed.estimates[k].hypotheses.front();
      const double apart =
          (first.world.mean().translation() - recording.truth[k].translation()).norm();
      right += apart < 0.02 && first.probability > 0.5 ? 1 : 0;
      ++count;
    }
  }
  RecordProperty("right", fmt::format("{} of {}", right, count));
  EXPECT_EQ(right, count);
}

// What comes later tells of a still object at every time the same, whatever part of the detector's
// slow error is left from one time to the next.
TEST(MovingObjectSmoother, AStillObjectIsWhereItIsAtTheEndInSpiteOfASlowError) {
  NoiseDependence dependence;
  dependence.slow = SlowError{.covariance = 4.0 * SceneNoise::inlier(), .correlation_time_s = 0.5};
  const DetectorNoise noise(
      {{.weight = 1.0 - 1e-9, .covariance = SceneNoise::inlier(), .frame = NoiseFrame::ray}},
      {.weight = 1e-9, .volume_m3 = 1.0}, dependence);
  MovingObjectSettings settings = plain_moving_settings();
  settings.lost_rate = 0.0;
  MovingScene scene(5, noise);
  MovingObjectSmoother smoother({noise}, {.models = {StaticMotion{}}}, settings);
  for (int k = 0; k < 15; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    smoother.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
  }
  const std::vector<MovingObjectEstimate> path = smoother.smoothed();
  const auto& end = path.back().hypotheses.front().world;
  const Eigen::LLT<Matrix6d> factor(end.covariance());
  for (const MovingObjectEstimate& estimate : path) {
    const auto& world = estimate.hypotheses.front().world;
    const Vector6d apart = (world.mean() * end.mean().inverse()).log();
    EXPECT_LT(factor.matrixL().solve(apart).norm(), 1e-9) << estimate.time_s;
    EXPECT_TRUE(world.covariance().isApprox(end.covariance(), 1e-9)) << estimate.time_s;
  }
}

// At every time the object is at one of its places, or lost: also where a part of it was lost that
// later detections found.
TEST(MovingObjectSmoother, HasProbabilitiesThatSumToOneAtEveryTime) {
  const DetectorNoise noise = SceneNoise{.clutter = 0.2}.noise();
  MovingScene scene(6, noise);
  MovingObjectSmoother smoother({noise}, {.models = {PutDownMotion{}}}, plain_moving_settings());
  for (int k = 0; k < 20; ++k) {
    if (k == 12) scene.put_down();
    scene.advance(StaticMotion{}, kFramePeriod_s);
    smoother.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
  }
  double least = 1.0;
  double most = 0.0;
  for (const MovingObjectEstimate& estimate : smoother.smoothed()) {
    double sum = estimate.lost_probability;
    for (const auto& hypothesis : estimate.hypotheses) sum += hypothesis.probability;
    EXPECT_NEAR(sum, 1.0, 1e-12) << estimate.time_s;
    least = std::min(least, estimate.lost_probability);
    most = std::max(most, estimate.lost_probability);
  }
  EXPECT_GT(most - least, 1e-6);
}

TEST(MovingObjectSmoother, KeepsSoManyStepsAndEndsWithTheFilter) {
  const DetectorNoise noise = SceneNoise{}.noise();
  const MotionModels models{.models = {ConstantVelocityMotion{sds(0.5, 0.1)}}};
  MovingScene scene(2, noise);
  MovingObjectSmoother all({noise}, models);
  MovingObjectSmoother lagged({noise}, models, {}, 6);
  for (int k = 0; k < 20; ++k) {
    scene.advance(models.models[0], kFramePeriod_s);
    const Observation observation = scene.observed(scene.inlier());
    all.update(observation, exact_camera(scene.camera));
    lagged.update(observation, exact_camera(scene.camera));
  }
  const auto whole = all.smoothed();
  const auto part = lagged.smoothed();
  ASSERT_EQ(whole.size(), 20U);
  ASSERT_EQ(part.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(part[k].time_s, whole[14 + k].time_s);
    EXPECT_EQ(part[k].hypotheses.front().world.covariance(),
              whole[14 + k].hypotheses.front().world.covariance());
  }
  EXPECT_EQ(part.back().hypotheses.front().world.mean().matrix(),
            lagged.filter().estimate().hypotheses.front().world.mean().matrix());
  EXPECT_NE(testing::thrown_message([&] { MovingObjectSmoother({noise}, models, {}, 0); }), "");
  EXPECT_NE(testing::thrown_message([&] { smooth_moving_object({noise}, models, {}, {}); }), "");
}

// A month leaves an object that moves anywhere, with predictions in between or without.
TEST(MovingObjectSmoother, KnowsBothSidesOfAMonthWithoutAnObservation) {
  const MotionModels both{.models = {StaticMotion{}, ConstantVelocityMotion{sds(0.3, 0.3)}},
                          .rates = Eigen::MatrixXd::Constant(2, 2, 0.1)};
  for (const MotionModels& models :
       {MotionModels{.models = {ConstantVelocityMotion{sds(0.3, 0.3)}}}, both}) {
    for (const bool predicts : {false, true}) {
      const DetectorNoise noise = SceneNoise{}.noise();
      MovingScene scene(6, noise);
      MovingObjectSmoother smoother({noise}, models, plain_moving_settings());
      std::vector<SE3d> truth;
      for (int k = 0; k < 8; ++k) {
        if (k == 4) {
          scene.put_down();
          scene.time_s += 2.6e6;
          if (predicts) smoother.predict(scene.time_s - 1.0);
        }
        scene.advance(StaticMotion{}, kFramePeriod_s);
        smoother.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
        truth.push_back(scene.truth);
      }
      std::vector<MovingObjectEstimate> smoothed = smoother.smoothed();
      if (predicts) smoothed.erase(smoothed.begin() + 4);
      ASSERT_EQ(smoothed.size(), truth.size());
      for (std::size_t k = 0; k < truth.size(); ++k) {
        double sum = smoothed[k].lost_probability;
        for (const auto& hypothesis : smoothed[k].hypotheses) sum += hypothesis.probability;
        EXPECT_NEAR(sum, 1.0, 1e-9) << k;
        ASSERT_FALSE(smoothed[k].hypotheses.empty()) << k;
        const auto& world = smoothed[k].hypotheses.front().world;
        EXPECT_LT((world.mean().translation() - truth[k].translation()).norm(), 0.03) << k;
        EXPECT_LT(nees_of(truth[k], world), 40.0) << k;
      }
    }
  }
}

}  // namespace
}  // namespace posemix
