// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Objects that are moved and put down, and detectors that are wrong in runs.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "moving_object_scene.hpp"

namespace posemix {
namespace {

using testing::kFlipOfObject;
using testing::MovingScene;
using testing::plain_moving_settings;
using testing::pose;
using testing::SceneNoise;
using testing::sds;

using testing::kFramePeriod_s;

bool is_at(const SE3d& truth, const MovingObjectEstimate& estimate) {
  if (estimate.hypotheses.empty()) return false;
  const SE3d& mean = estimate.hypotheses.front().world.mean();
  return (truth.rotation().inverse() * mean.rotation()).angle() < radians(20.0) &&
         (truth.translation() - mean.translation()).norm() < 0.04;
}

MotionModels put_down_models() {
  return {.models = {StaticMotion{}, PutDownMotion{}}, .rates = {}, .start = {0.05, 0.95}};
}

MovingObjectFilter tracker(const DetectorNoise& noise, const MotionModels& models) {
  return MovingObjectFilter({noise}, models, plain_moving_settings());
}

/// Detections until the leading hypothesis is where an object was put down; 99 if it never is.
int detections_until_noticed(std::uint64_t seed, const DetectorNoise& noise,
                             const MotionModels& models) {
  MovingScene scene(seed, noise);
  MovingObjectFilter filter = tracker(noise, models);
  for (int k = 0; k < 30; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(scene.detect()), exact_camera(scene.camera));
  }
  scene.put_down();
  for (int k = 1; k <= 30; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(scene.detect()), exact_camera(scene.camera));
    if (is_at(scene.truth, filter.estimate())) return k;
  }
  return 99;
}

// The detector is wrong in one of 50 detections, and stays so for a second in half of the cases; 4
// % are gross errors.
TEST(MovingObjectJumps, AreNoticedWithinFiveDetections) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.02, .mode_time_s = 1.0}.noise();
  constexpr int kSeeds = 1000;
  int within_five = 0;
  double sum = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const int after =
        detections_until_noticed(static_cast<std::uint64_t>(seed), noise, put_down_models());
    within_five += after <= 5 ? 1 : 0;
    sum += after;
  }
  RecordProperty("within_five", within_five);
  RecordProperty("mean", fmt::format("{:.2f}", sum / kSeeds));
  EXPECT_GE(within_five, 990);
}

struct FalseJumps {
  int detections = 0;
  int jumps = 0;  ///< times that the leading hypothesis left the true place
  int right = 0;  ///< detections after which it is there
};

/// A still object and a detector that turns it by half a circle for runs of 30 detections, one
/// detection in four.
FalseJumps false_jumps(const DetectorNoise& noise, const MotionModels& models, int seeds,
                       int frames, int run, const SE3d& flip) {
  FalseJumps result;
  for (int seed = 0; seed < seeds; ++seed) {
    // Besides the runs one detection in 200 is wrong, and 4 % are gross errors.
    MovingScene scene(static_cast<std::uint64_t>(seed),
                      SceneNoise{.gross = 0.04, .clutter = 0.005}.noise());
    MovingObjectFilter filter = tracker(noise, models);
    bool was_right = true;
    int in_run = 0;
    for (int k = 0; k < frames; ++k) {
      scene.advance(StaticMotion{}, kFramePeriod_s);
      if (k > 300 && in_run == 0 && scene.stream.uniform() < 1.0 / (3.0 * run)) in_run = run;
      const SE3d seen = in_run > 0 ? scene.erring(scene.truth * flip, noise.components().front())
                                   : scene.detect();
      in_run = std::max(0, in_run - 1);
      filter.update(scene.observed(seen), exact_camera(scene.camera));
      if (k < 300) continue;
      const bool right = is_at(scene.truth, filter.estimate());
      if (was_right && !right) ++result.jumps;
      was_right = right;
      ++result.detections;
      result.right += right ? 1 : 0;
    }
  }
  return result;
}

// The noise knows of flips as a mode.
TEST(MovingObjectJumps, AreNotSeenInRunsOfKnownFlips) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.02, .flips = 0.25, .mode_time_s = 3.0}.noise();
  const FalseJumps result = false_jumps(noise, put_down_models(), 30, 1300, 30, kFlipOfObject);
  RecordProperty("jumps", result.jumps);
  RecordProperty("right", result.right);
  EXPECT_LE(result.jumps, result.detections / 10000);
  EXPECT_GE(result.right, result.detections * 0.999);
}

// The noise knows only that a part of the detections is wrong, for three seconds on average.
TEST(MovingObjectJumps, AreNotSeenInRunsOfFlipsThatTheNoiseDoesNotKnow) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.25, .mode_time_s = 3.0}.noise();
  const FalseJumps result = false_jumps(noise, put_down_models(), 30, 1300, 30, kFlipOfObject);
  RecordProperty("jumps", result.jumps);
  RecordProperty("right", result.right);
  EXPECT_LE(result.jumps, result.detections / 10000);
  EXPECT_GE(result.right, result.detections * 0.999);
}

// The same at another place: the detector sees something else for three seconds.
TEST(MovingObjectJumps, ElsewhereAreAsProbableAsTheRatesSay) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.25, .mode_time_s = 3.0}.noise();
  MotionModels rare = put_down_models();
  std::get<PutDownMotion>(rare.models[1]).jump_rate = 1e-4;
  const FalseJumps result =
      false_jumps(noise, rare, 30, 1300, 30, pose(0.5, 0.2, 1.0, 0.2, -0.1, 0.1));
  RecordProperty("jumps", result.jumps);
  RecordProperty("right", result.right);
  EXPECT_LE(result.jumps, result.detections / 10000);
}

// A run begins with the rate r / t_m and goes on with exp(-t / t_m), a jump has the rate of the
// model: the odds of a new place after n detections there, written down anew.
TEST(MovingObjectJumps, HaveTheOddsOfTheRatesOfRunsAndJumps) {
  const double mode_time = 2.0;
  const double clutter = 0.1;
  const DetectorNoise noise =
      SceneNoise{.gross = 0.0, .clutter = clutter, .mode_time_s = mode_time}.noise();
  MovingObjectSettings settings = plain_moving_settings();
  settings.isolated_clutter = 0.0;
  settings.turned_clutter = 0.0;
  settings.lost_rate = 0.0;
  const double rate = 0.05;
  MovingObjectFilter filter({noise}, {.models = {PutDownMotion{.jump_rate = rate}}}, settings);
  MovingScene scene(1, noise);
  double t = 0.0;
  const auto see = [&](const SE3d& at) {
    Observation observation = observation_of(at);
    observation.stamp_s = t;
    filter.update(observation, exact_camera(scene.camera));
    t += kFramePeriod_s;
  };
  const SE3d here = scene.camera.inverse() * scene.truth;
  const SE3d there = here * pose(0.5, 1.0, 0.4, 0.2, 0.1, 0.1);
  for (int k = 0; k < 200; ++k) see(here);
  const double stay = std::exp(-kFramePeriod_s / mode_time);
  const double jump = -std::expm1(-rate * kFramePeriod_s);
  // The object here and a run, or put down there and right.
  double run_there = (1.0 - jump) * (1.0 - stay) * clutter;
  double put_there = jump * (stay + (1.0 - stay) * (1.0 - clutter));
  for (int n = 1; n <= 12; ++n) {
    see(there);
    const MovingObjectEstimate estimate = filter.estimate();
    const auto at = [&](const SE3d& place) {
      for (const auto& hypothesis : estimate.hypotheses) {
        if ((hypothesis.world.mean().translation() - (scene.camera * place).translation()).norm() <
            0.01)
          return hypothesis.probability;
      }
      return 0.0;
    };
    EXPECT_NEAR(std::log(at(there) / at(here)), std::log(put_there / run_there), 0.02) << n;
    // A run that is drawn anew is at the other place in one half of the cases.
    run_there *= (1.0 - jump) * (stay + (1.0 - stay) * 0.5 * clutter);
    put_there *= (1.0 - jump) * (stay + (1.0 - stay) * (1.0 - clutter));
  }
}

/// Detections of a moving object of which a part is flipped in runs: how often the leading
/// hypothesis is right.
double right_while_moving(const SceneNoise& model, int run, double part, double& worst_run) {
  const DetectorNoise noise = model.noise();
  const ConstantVelocityMotion motion{sds(0.4, 0.08), MotionFrame::object, sds(0.5, 0.15)};
  int right = 0;
  int count = 0;
  int longest = 0;
  for (int seed = 0; seed < 60; ++seed) {
    MovingScene scene(static_cast<std::uint64_t>(seed), noise);
    scene.twist = testing::draw(motion.start_sds.cwiseAbs2().asDiagonal(), scene.stream);
    MovingObjectFilter filter = tracker(noise, {.models = {motion}});
    int in_run = 0;
    int wrong = 0;
    for (int k = 0; k < 200; ++k) {
      scene.advance(motion, 0.05);
      if (k > 80 && in_run == 0 && scene.stream.uniform() < part / ((1.0 - part) * run))
        in_run = run;
      const SE3d object = in_run > 0 ? scene.truth * kFlipOfObject : scene.truth;
      in_run = std::max(0, in_run - 1);
      filter.update(scene.observed(scene.erring(object, noise.components().front())),
                    exact_camera(scene.camera));
      if (k < 80) continue;
      const bool is_right = is_at(scene.truth, filter.estimate());
      right += is_right ? 1 : 0;
      wrong = is_right ? 0 : wrong + 1;
      longest = std::max(longest, wrong);
      ++count;
    }
  }
  worst_run = longest;
  return static_cast<double>(right) / count;
}

TEST(MovingObjectJumps, FlipsOfAMovingObjectAreRecovered) {
  double longest = 0.0;
  const double known = right_while_moving(
      {.gross = 0.04, .clutter = 0.02, .flips = 0.1, .mode_time_s = 0.5}, 10, 0.1, longest);
  RecordProperty("known", fmt::format("{:.4f}, longest {}", known, longest));
  EXPECT_GT(known, 0.99);
  const double unknown =
      right_while_moving({.gross = 0.04, .clutter = 0.2, .mode_time_s = 0.5}, 10, 0.2, longest);
  RecordProperty("unknown", fmt::format("{:.4f}, longest {}", unknown, longest));
  EXPECT_GT(unknown, 0.95);
}

}  // namespace
}  // namespace posemix
