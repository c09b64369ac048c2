// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "filter/scenario.hpp"
#include "posemix/slam/method.hpp"
#include "posemix/slam/object_slam.hpp"
#include "posemix/testing/expect.hpp"

/// A frame that is refused leaves no trace: what follows is as if it had not been tried.
namespace posemix {
namespace {

using testing::draw;
using testing::gaussian_noise;
using testing::heavy_tailed_noise;
using testing::isotropic;
using testing::pose;
using testing::thrown_message;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const PoseDensity kRefusedStart(pose(0.1, 0.2, -0.1, 0.3, -0.2, 0.1), isotropic(0.5, 0.005));
const SE3d kMotion = pose(0.01, -0.02, 0.01, 0.02, 0.01, -0.01);
const SE3d kNoPose(SO3d(), {0.0, kNan, 1.0});

/// Frames of a camera that moves past two objects with errors; some detections are missing.
std::vector<FrameInput> good_frames() {
  const std::vector<SE3d> objects{pose(0.4, -0.3, 0.2, 0.1, 0.2, 1.1),
                                  pose(-0.2, 0.5, 0.1, -0.3, 0.1, 1.4)};
  RandomStream stream(4);
  SE3d camera = kRefusedStart.mean();
  std::vector<FrameInput> frames;
  for (int k = 0; k < 12; ++k) {
    FrameInput& frame = frames.emplace_back();
    frame.dt = 0.1;
    if (k % 5 != 4) frame.motion = kMotion;
    camera = camera * kMotion;
    for (const SE3d& object : objects) {
      const SE3d seen = camera.inverse() * object * SE3d::exp(draw(isotropic(3.0, 0.01), stream));
      frame.detections.push_back(stream.uniform() < 0.8 ? std::optional(seen) : std::nullopt);
    }
  }
  return frames;
}

/// The frame with one change that makes it wrong.
struct Bad {
  std::string name;
  std::function<void(FrameInput&)> change;
};

std::vector<Bad> bad_changes() {
  return {{"too few detections", [](FrameInput& f) { f.detections.pop_back(); }},
          {"too many detections", [](FrameInput& f) { f.detections.emplace_back(); }},
          {"a detection is NaN", [](FrameInput& f) { f.detections[1] = kNoPose; }},
          {"a turn is NaN",
           [](FrameInput& f) {
             f.detections[0] = SE3d(SO3d::exp({kNan, 0.0, 0.0}), {0.0, 0.0, 1.0});
           }},
          {"a detection is infinite",
           [](FrameInput& f) {
             f.detections[0] = SE3d(SO3d(), {0.0, kInfinity, 1.0});
           }},
          {"a detection is too far for its square to be finite",
           [](FrameInput& f) {
             f.detections[0] = SE3d(SO3d(), {0.0, 1e160, 1.0});
           }},
          {"the motion is too long",
           [](FrameInput& f) {
             f.motion = SE3d(SO3d(), {1e160, 0.0, 0.0});
           }},
          {"the motion is NaN", [](FrameInput& f) { f.motion = kNoPose; }},
          {"a candidate is NaN",
           [](FrameInput& f) {
             f.candidates = {{"a", kNoPose, 1.0}};
           }},
          {"a score is NaN",
           [](FrameInput& f) {
             f.candidates = {{"a", SE3d(SO3d(), {0.0, 0.0, 1.0}), kNan}};
           }},
          {"dt is zero", [](FrameInput& f) { f.dt = 0.0; }},
          {"dt is NaN", [](FrameInput& f) { f.dt = kNan; }},
          {"dt is too long", [](FrameInput& f) {
             f.dt = std::numeric_limits<double>::max();
             f.motion.reset();
           }}};
}

struct Case {
  std::string name;
  ObjectSlamSettings settings;
};

std::vector<Case> cases() {
  GaussianSumSettings joint;
  joint.noise_use = NoiseUse::joint;
  MotionSettings constant_velocity;
  constant_velocity.model = MotionModel::constant_velocity;
  MotionSettings vague;
  vague.unknown_motion = {isotropic(1e5, 1e3), NoisePer::second};
  return {{"multi-object", {.motion = vague, .record_hypotheses = true}},
          {"multi-object, constant velocity", {.motion = constant_velocity}},
          {"Gaussian sum",
           {.motion = vague, .tracker = GaussianSumSettings{}, .record_hypotheses = true}},
          {"Gaussian sum, joint", {.motion = vague, .tracker = joint}},
          {"Gaussian sum, constant velocity",
           {.motion = constant_velocity, .tracker = GaussianSumSettings{}}},
          {"particles", {.motion = vague, .tracker = ParticleFilterSettings{.particles = 20}}}};
}

ObjectSlam make_refusing(const ObjectSlamSettings& settings) {
  return {kRefusedStart,
          {{.id = "a", .noise = heavy_tailed_noise()}, {.id = "b", .noise = heavy_tailed_noise()}},
          settings};
}

void expect_same(const FrameEstimate& actual, const FrameEstimate& expected) {
  EXPECT_EQ(actual.camera.covariance(), expected.camera.covariance());
  EXPECT_EQ(actual.camera.mean().matrix(), expected.camera.mean().matrix());
  EXPECT_EQ(actual.report.statuses, expected.report.statuses);
  EXPECT_EQ(actual.report.update.log_evidence, expected.report.update.log_evidence);
  EXPECT_EQ(actual.mode_probabilities, expected.mode_probabilities);
  EXPECT_EQ(actual.pose_indices, expected.pose_indices);
  for (std::size_t j = 0; j < expected.objects.size(); ++j) {
    ASSERT_EQ(actual.objects[j].has_value(), expected.objects[j].has_value());
    if (!expected.objects[j]) continue;
    EXPECT_EQ(actual.objects[j]->covariance(), expected.objects[j]->covariance());
    EXPECT_EQ(actual.relative[j]->mean().matrix(), expected.relative[j]->mean().matrix());
  }
}

void expect_same(const ObjectSlam& actual, const ObjectSlam& expected) {
  EXPECT_EQ(actual.estimate().covariance(), expected.estimate().covariance());
  for (std::size_t j = 0; j < expected.objects().size(); ++j)
    EXPECT_EQ(actual.detections(j), expected.detections(j));
  const Posterior a = actual.posterior();
  const Posterior b = expected.posterior();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].log_weight, b[i].log_weight);
    EXPECT_EQ(a[i].density.covariance(), b[i].density.covariance());
  }
}

TEST(RefusedFrames, LeaveNoTraceInAnyTracker) {
  for (const auto& [name, settings] : cases()) {
    SCOPED_TRACE(name);
    ObjectSlam expected = make_refusing(settings);
    ObjectSlam actual = make_refusing(settings);
    bool first = true;
    for (const FrameInput& good : good_frames()) {
      for (const Bad& bad : bad_changes()) {
        if (first && bad.name.starts_with("dt")) continue;  // the first frame has no time
        SCOPED_TRACE(bad.name);
        FrameInput changed = good;
        bad.change(changed);
        EXPECT_NE(thrown_message([&] { actual.step(changed); }), "");
      }
      expect_same(actual.step(good), expected.step(good));
      expect_same(actual, expected);
      first = false;
    }
  }
}

TEST(RefusedFrames, NameWhatIsNotFinite) {
  for (const auto& [name, settings] : cases()) {
    SCOPED_TRACE(name);
    ObjectSlam slam = make_refusing(settings);
    const auto message = [&](const FrameInput& input) {
      return thrown_message([&] { slam.step(input); });
    };
    EXPECT_EQ(message({.detections = {std::nullopt, kNoPose}}),
              "frame: the detection of 'b': the pose holds a value that is not finite");
    EXPECT_EQ(message({.motion = kNoPose, .detections = {std::nullopt, std::nullopt}}),
              "frame: the motion holds a value that is not finite");
    EXPECT_EQ(message({.detections = {std::nullopt}}), "frame: 1 detections for 2 objects");
  }
}

TEST(RefusedFrames, NoiseThatDoesNotGoTogetherLeavesNoTrace) {
  GaussianSumSettings joint;
  joint.noise_use = NoiseUse::joint;
  const auto make_joint = [&] {
    return ObjectSlam(
        kRefusedStart,
        {{.id = "a", .noise = heavy_tailed_noise()}, {.id = "b", .noise = gaussian_noise()}},
        {.tracker = joint});
  };
  ObjectSlam actual = make_joint();
  ObjectSlam expected = make_joint();
  for (FrameInput frame : good_frames()) {
    const bool both =
        frame.detections[0] && frame.detections[1] && actual.pose_index(0) && actual.pose_index(1);
    if (both) {
      EXPECT_NE(thrown_message([&] { actual.step(frame); }), "");
      frame.detections[1].reset();
    }
    expect_same(actual.step(frame), expected.step(frame));
  }
  EXPECT_TRUE(actual.pose_index(0) && actual.pose_index(1));
}

TEST(RefusedFrames, ModelsAndSettingsAreCheckedBefore) {
  const auto refused = [](const ObjectModel& model, const TrackerSettings& tracker) {
    return thrown_message([&] { ObjectSlam(kRefusedStart, {model}, {.tracker = tracker}); });
  };
  ObjectModel independent{.id = "a", .noise = gaussian_noise()};
  independent.independent_start = -Matrix6d::Identity();
  EXPECT_EQ(refused(independent, GaussianSumSettings{}),
            "independent start of object 'a' is not positive definite");
  const ObjectModel model{.id = "a", .noise = gaussian_noise()};
  ParticleFilterSettings particles;
  particles.object_walk.covariance = -Matrix6d::Identity();
  EXPECT_EQ(refused(model, particles), "particle filter: object_walk has a negative variance");
  GaussianSumSettings pruning;
  pruning.reduction.prune_below = kNan;
  EXPECT_EQ(refused(model, pruning).find("filter: prune_below"), 0U);
}

}  // namespace
}  // namespace posemix
