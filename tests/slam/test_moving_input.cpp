// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "moving_orbit.hpp"
#include "posemix/slam/run.hpp"
#include "posemix/slam/smoothing.hpp"
#include "posemix/slam/stamped_slam.hpp"
#include "posemix/testing/expect.hpp"

/// Input of object SLAM with objects that move: frames, cameras, stamps, and what is refused.
namespace posemix {
namespace {

using testing::expect_same_bits;
using testing::hand;
using testing::isotropic;
using testing::moving_by;
using testing::pose;
using testing::ray_noise;
using testing::start_near;
using testing::thrown_message;

TEST(MovingSlam, AnAttachedObjectMovesWithItsFrame) {
  MultiObjectSlamSettings settings;
  settings.frames = {"gripper"};
  MultiObjectSlam slam({testing::scene_camera(), isotropic(0.01, 1e-4)},
                       {hand(moving_by(AttachedMotion{}))}, settings);
  const SE3d gripper = pose(0.1, 0.2, 0.0, 0.1, 0.0, 0.1);
  const SE3d seen = pose(0, 0, 0, 0, 0, 0.8);
  EXPECT_NE(thrown_message([&] {
              slam.step({.detections = {seen}});
            }).find("'gripper', which may hold an object, had no pose"),
            std::string::npos);
  slam.step({.detections = {seen}, .frames = {KnownFrame{gripper}}});
  const PoseDensity before = *slam.object_at(0, 0.0);
  const SE3d moved = pose(0, 0, 0.3, 0.2, 0.1, 0.0);
  const FrameEstimate now =
      slam.step({.dt = 0.1, .motion = SE3d(), .frames = {KnownFrame{moved * gripper}}});
  EXPECT_LT((moved * before.mean() * now.objects[0]->mean().inverse()).log().norm(), 1e-9);
  // A frame that is not given is where it was.
  const FrameEstimate later = slam.step({.dt = 0.1, .motion = SE3d(), .frames = {std::nullopt}});
  EXPECT_LT((later.objects[0]->mean() * now.objects[0]->mean().inverse()).log().norm(), 1e-9);
}

TEST(MovingSlam, CamerasOfARigSeeOneObject) {
  const SE3d left = pose(0, 0.1, 0, -0.1, 0, 0);
  const SE3d right = pose(0, -0.1, 0, 0.1, 0, 0);
  MultiObjectSlamSettings settings;
  settings.cameras = {{"left", left, {}}, {"right", right, isotropic(0.5, 0.002)}};
  const SE3d body = testing::scene_camera();
  MultiObjectSlam slam({body, isotropic(0.1, 1e-3)}, {hand()}, settings);
  const SE3d truth = pose(0.2, 0.1, 0, 0.05, 0, 0);
  for (int k = 0; k < 10; ++k) {
    const bool is_left = k % 2 == 0;
    Observation seen = observation_of((body * (is_left ? left : right)).inverse() * truth);
    seen.object = "hand";
    seen.camera = is_left ? "left" : "right";
    const FrameEstimate now = slam.step({.dt = 0.1, .motion = SE3d(), .observations = {seen}});
    EXPECT_LT((now.objects[0]->mean() * truth.inverse()).log().norm(), 1e-3);
    EXPECT_LT((now.relative[0]->mean() * (truth.inverse() * body)).log().norm(), 1e-3);
  }
}

TEST(MovingSlam, AnObjectThatIsPutDownElsewhereIsInTheJointGaussian) {
  ObjectModel box{.id = "box", .noise = ray_noise(), .motion = moving_by(PutDownMotion{})};
  MultiObjectSlam slam({testing::scene_camera(), isotropic(0.01, 1e-4)}, {box});
  const SE3d here = pose(0, 0, 0, 0, 0, 0.8);
  const SE3d there = pose(0, 0, 0, 0.3, 0, 0.8);
  FrameEstimate now = slam.step({.detections = {here}});
  for (int k = 0; k < 40; ++k)
    now = slam.step({.dt = 1.0, .motion = SE3d(), .detections = {k < 20 ? here : there}});
  EXPECT_TRUE(now.pose_indices[0]);
  EXPECT_FALSE(slam.moving().has(0));
  EXPECT_NEAR(now.relative[0]->mean().translation().x(), 0.3, 0.02);
}

TEST(MovingSlam, AStillCameraStays) {
  const PoseDensity camera(testing::scene_camera(), isotropic(0.1, 1e-3));
  MultiObjectSlam slam(camera, {hand()}, {}, {.model = MotionModel::still});
  slam.step({});
  const FrameEstimate now = slam.step({.dt = 10.0, .detections = {pose(0, 0, 0, 0, 0, 1)}});
  EXPECT_LT((now.camera.mean() * camera.mean().inverse()).log().norm(), 1e-14);
  EXPECT_LT((now.camera.covariance() - camera.covariance()).norm(), 1e-14);
}

TEST(MovingSlam, StampedInputInAnyOrderGivesTheSameBits) {
  struct Input {
    double stamp_s;
    std::optional<SE3d> odometry;
    Observation observation = {};
  };
  RandomStream stream(3, 1);
  std::vector<Input> inputs;
  const auto body_at = [](double t) {
    return SE3d::exp(t * (Vector6d() << 0.0, 0.1, 0.2, 0.1, 0.0, 0.05).finished());
  };
  for (int k = 0; k <= 60; ++k) {
    const double t = 0.05 * k;
    inputs.push_back({t, body_at(t)});
    for (const char* id : {"box", "hand"}) {
      const SE3d truth = pose(0.2, 0.1, 0.4, id[0] == 'b' ? 0.3 : 0.1 * t, 0.1, 1.0);
      Observation seen = observation_of(body_at(t + 0.01).inverse() * truth *
                                        SE3d::exp(testing::draw(isotropic(1.0, 0.005), stream)));
      seen.object = id;
      seen.stamp_s = t + 0.01;
      if (k < 60) inputs.push_back({t + 0.01, std::nullopt, seen});
    }
  }
  const auto result = [&](std::vector<Input> given) {
    StampedSlam slam({SE3d(), isotropic(0.1, 0.001)}, {{.id = "box"}, hand(calm_and_agile())});
    for (const Input& input : given) {
      if (input.odometry) {
        slam.add_odometry(input.stamp_s, *input.odometry);
      } else {
        slam.add(input.observation);
      }
      slam.estimate();
    }
    return slam.finish()->estimate;
  };
  const FrameEstimate expected = result(inputs);
  for (std::size_t k = 0; k + 8 < inputs.size(); k += 8)
    std::reverse(inputs.begin() + static_cast<std::ptrdiff_t>(k),
                 inputs.begin() + static_cast<std::ptrdiff_t>(k + 8));
  const FrameEstimate late = result(inputs);
  expect_same_bits(late.camera, expected.camera);
  expect_same_bits(*late.objects[1], *expected.objects[1]);
  EXPECT_EQ(late.motion_models, expected.motion_models);
  EXPECT_EQ(late.twists[1]->mean, expected.twists[1]->mean);
}

TEST(MovingSlam, RefusesWhatItCannotDo) {
  const auto message = [](const ObjectModel& model, const MultiObjectSlamSettings& settings = {}) {
    return thrown_message([&] {
      MultiObjectSlam({SE3d(), isotropic(1.0, 0.01)}, {model}, settings);
    });
  };
  ObjectModel model = hand();
  model.detectors = {{"a", ray_noise()}};
  EXPECT_NE(message(model).find("object 'hand': it moves and has 2 noise models"),
            std::string::npos);
  model = hand();
  model.prior = ObjectPrior{start_near(SE3d())};
  EXPECT_NE(message(model).find("object 'hand': it moves and has a prior"), std::string::npos);
  EXPECT_NE(message(hand(moving_by(AttachedMotion{.frame = 1})), {.frames = {"arm"}})
                .find("object 'hand': it may be held by frame 1"),
            std::string::npos);
  EXPECT_NE(message(hand({.models = {}})).find("no motion model"), std::string::npos);
  EXPECT_NE(message(hand(moving_by(RandomWalkMotion{.break_rate = -1.0}))).find("object 'hand': "),
            std::string::npos);
  MultiObjectSlamSettings on_sight;
  on_sight.on_sight = hand();
  on_sight.on_sight->detectors = {{"a", ray_noise()}};
  EXPECT_NE(message({.id = "box"}, on_sight).find("2 noise models"), std::string::npos);

  const PoseDensity camera(SE3d(), isotropic(1.0, 0.01));
  for (const TrackerSettings& tracker :
       {TrackerSettings(GaussianSumSettings()), TrackerSettings(ParticleFilterSettings())}) {
    EXPECT_NE(thrown_message([&] {
                ObjectSlam(camera, {hand()}, {.tracker = tracker});
              }).find("object 'hand' moves by the model 'constant_velocity'"),
              std::string::npos);
  }
  EXPECT_NE(thrown_message([&] {
              GaussianSumSlam(camera, {{.id = "box"}}, {}, {.model = MotionModel::given});
            }).find("the motion model is \"given\""),
            std::string::npos);
  EXPECT_NE(thrown_message([&] {
              FixedLagSmoother(camera, {hand()}, {}, {.lag_frames = 2});
            }).find("smoothing by a fixed lag: object 'hand' moves"),
            std::string::npos);
  // An object that may come on sight may be held, too.
  MultiObjectSlamSettings held{.frames = {"arm"}};
  held.on_sight = hand(moving_by(AttachedMotion{}));
  EXPECT_NE(thrown_message([&] {
              MultiObjectSlam(camera, {{.id = "box"}}, held).step({});
            }).find("'arm', which may hold an object, had no pose"),
            std::string::npos);
  MultiObjectSlam slam(camera, {hand()});
  EXPECT_NE(
      thrown_message([&] { slam.step({.frames = {KnownFrame{}}}); }).find("1 poses of frames"),
      std::string::npos);
}

TEST(MovingSlam, FramesOfStampedInputComeInAnyOrderToo) {
  struct Input {
    double stamp_s;
    bool is_frame;
  };
  std::vector<Input> inputs;
  for (int k = 0; k <= 30; ++k) {
    inputs.push_back({0.1 * k, true});
    inputs.push_back({0.1 * k + 0.03, false});
  }
  const SE3d camera = testing::scene_camera();
  const auto arm_at = [](double t) { return pose(0.1 * t, 0, 0.2 * t, 0.05 * t, 0, 0); };
  const SE3d in_grip = pose(0.3, 0, 0, 0, 0, 0.05);
  const auto result = [&](const std::vector<Input>& given) {
    MultiObjectSlamSettings settings;
    settings.frames = {"arm"};
    StampedSlam slam({camera, isotropic(0.01, 1e-4)}, {hand(moving_by(AttachedMotion{}))}, settings,
                     {.model = MotionModel::still});
    for (const Input& input : given) {
      if (input.is_frame) {
        slam.add_frame("arm", input.stamp_s, {arm_at(input.stamp_s)});
      } else {
        Observation seen = observation_of(camera.inverse() * arm_at(input.stamp_s) * in_grip);
        seen.object = "hand";
        seen.stamp_s = input.stamp_s;
        slam.add(seen);
      }
      slam.estimate();
    }
    EXPECT_NE(thrown_message([&] { slam.add_frame("leg", 3.0, {}); }).find("no frame 'leg'"),
              std::string::npos);
    EXPECT_NE(thrown_message([&] { slam.add_frame("arm", 3.0, {}); }).find("already"),
              std::string::npos);
    EXPECT_NE(thrown_message([&] { (void)slam.object_at("hand", 0.0); }).find("or later"),
              std::string::npos);
    const EstimateAtStamp now = slam.finish().value();
    expect_same_bits(*slam.object_at("hand", now.stamp_s), *now.estimate.objects[0]);
    EXPECT_GT(slam.object_at("hand", now.stamp_s + 1.0)->covariance().trace(), 0.0);
    return now;
  };
  const EstimateAtStamp expected = result(inputs);
  const SE3d truth = arm_at(expected.stamp_s) * in_grip;
  // After the last pose of the arm it is where it was.
  EXPECT_LT((expected.estimate.objects[0]->mean() * truth.inverse()).log().norm(), 0.01);
  for (std::size_t k = 0; k + 6 < inputs.size(); k += 6)
    std::reverse(inputs.begin() + static_cast<std::ptrdiff_t>(k),
                 inputs.begin() + static_cast<std::ptrdiff_t>(k + 6));
  expect_same_bits(*result(inputs).estimate.objects[0], *expected.estimate.objects[0]);
}

TEST(MovingSlam, InputWaitsForTheFirstPosesOfFramesThatMayHoldAnObject) {
  MultiObjectSlamSettings settings;
  settings.frames = {"arm", "never used"};
  const SE3d camera = testing::scene_camera();
  const auto begun = [&] {
    return StampedSlam({camera, isotropic(0.01, 1e-4)}, {hand(moving_by(AttachedMotion{}))},
                       settings, {.model = MotionModel::still});
  };
  const auto add = [&](StampedSlam& slam, double stamp_s) {
    Observation seen = observation_of(pose(0, 0, 0, 0, 0, 0.8));
    seen.object = "hand";
    seen.stamp_s = stamp_s;
    slam.add(seen);
  };
  StampedSlam slam = begun();
  for (int k = 0; k <= 100; ++k) {
    add(slam, 0.1 * k);
    EXPECT_FALSE(slam.estimate());
  }
  EXPECT_EQ(slam.missing_frames(), std::vector<std::string>{"arm"});
  // What is older than twice the history, of one second, is not kept.
  EXPECT_EQ(slam.waiting(), 21U);
  EXPECT_EQ(slam.counts().too_late, 80U);
  EXPECT_NE(thrown_message([&] { slam.finish(); }).find("'arm', which may hold an object"),
            std::string::npos);
  slam.add_frame("arm", 10.05, {SE3d()});
  EXPECT_TRUE(slam.missing_frames().empty());
  EXPECT_EQ(slam.waiting(), 0U);
  ASSERT_TRUE(slam.estimate());
  EXPECT_DOUBLE_EQ(slam.estimate()->stamp_s, 10.0);
  // From a history before the first pose on.
  EXPECT_EQ(slam.slam().detections(0), 10U);

  // The order of what comes changes nothing.
  StampedSlam other = begun();
  for (int k = 90; k <= 99; ++k) add(other, 0.1 * k);
  other.add_frame("arm", 10.05, {SE3d()});
  add(other, 0.1 * 100);
  EXPECT_EQ(other.counts().too_late, 0U);
  expect_same_bits(*other.estimate()->estimate.objects[0], *slam.estimate()->estimate.objects[0]);
  EXPECT_EQ(other.slam().detections(0), 10U);
}

}  // namespace
}  // namespace posemix
