// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/multi_object_slam.hpp"

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "moving_orbit.hpp"
#include "posemix/slam/state.hpp"
#include "posemix/testing/expect.hpp"

/// Objects that move beside static ones.
namespace posemix {
namespace {

using testing::expect_same_bits;
using testing::hand;
using testing::isotropic;
using testing::moving_by;
using testing::MovingOrbit;
using testing::nees_of;
using testing::plain_slam;
using testing::pose;
using testing::ray_noise;
using testing::SceneNoise;
using testing::start_near;
using testing::static_models;
using testing::thrown_message;

TEST(MovingSlam, AMovingObjectLeavesCameraAndStaticObjectsToTheLastBit) {
  MovingOrbit scene(1);
  std::vector<ObjectModel> models = static_models();
  models.insert(models.begin() + 1, hand());
  MultiObjectSlam with(start_near(scene.camera), models);
  MultiObjectSlam without(start_near(scene.camera), static_models());
  for (int k = 0; k < 60; ++k) {
    FrameInput input{.dt = 0.1};
    if (k > 0) input.motion = scene.next();
    input.detections = {scene.detect(0, 0.1, 0.1), scene.moving.inlier(),
                        scene.detect(1, 0.1, 0.1)};
    const FrameEstimate a = with.step(input);
    input.detections.erase(input.detections.begin() + 1);
    const FrameEstimate b = without.step(input);
    expect_same_bits(a.camera, b.camera);
    expect_same_bits(*a.objects[0], *b.objects[0]);
    expect_same_bits(*a.objects[2], *b.objects[1]);
    expect_same_bits(*a.relative[2], *b.relative[1]);
  }
  EXPECT_FALSE(with.pose_index(1));
  EXPECT_EQ(with.estimate().mean().size(), without.estimate().mean().size());
  EXPECT_EQ(with.detections(1), 60U);
}

TEST(MovingSlam, ModelsThatAreAllStaticAreTheJointFilter) {
  MovingOrbit scene(2);
  std::vector<ObjectModel> models = static_models();
  models[0].motion.models = {StaticMotion{}, StaticMotion{}};
  MultiObjectSlam several(start_near(scene.camera), models);
  MultiObjectSlam one(start_near(scene.camera), static_models());
  for (int k = 0; k < 20; ++k) {
    FrameInput input{.dt = 0.1};
    if (k > 0) input.motion = scene.next();
    input.detections = {scene.detect(0, 0.1, 0.1), scene.detect(1, 0.1, 0.1)};
    const FrameEstimate a = several.step(input);
    const FrameEstimate b = one.step(input);
    expect_same_bits(*a.objects[0], *b.objects[0]);
    EXPECT_TRUE(a.motion_models[0].empty());
    EXPECT_FALSE(a.twists[0]);
  }
}

TEST(MovingSlam, ErrorsBeforeAMovingCameraAreAsStated) {
  double world = 0.0;
  double relative = 0.0;
  double ahead = 0.0;
  double count = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    MovingOrbit scene(seed);
    std::vector<ObjectModel> models = static_models();
    models.push_back(hand());
    const SE3d stated =
        SE3d::exp(testing::draw(isotropic(0.3, 0.005), scene.stream)) * scene.camera;
    MultiObjectSlamSettings settings = plain_slam();
    settings.moving = testing::plain_moving_settings();
    MotionSettings motion;
    motion.noise = {scene.q, NoisePer::frame};
    MultiObjectSlam slam(start_near(stated), models, settings, motion);
    std::optional<PoseDensity> predicted;
    for (int k = 0; k < 60; ++k) {
      FrameInput input{.dt = 0.1};
      if (k > 0) input.motion = scene.next();
      input.detections = {scene.detect(0, 0.0, 0.0), scene.detect(1, 0.0, 0.0), std::nullopt};
      if (k % 3 != 2) input.detections[2] = scene.moving.inlier();
      const FrameEstimate now = slam.step(input);
      if (predicted && k > 20) ahead += nees_of(scene.moving.truth, *predicted) / 6.0;
      predicted = slam.object_at(2, 0.1);
      if (k <= 20) continue;
      world += nees_of(scene.moving.truth, *now.objects[2]) / 6.0;
      relative += nees_of(scene.camera.inverse() * scene.moving.truth, *now.relative[2]) / 6.0;
      count += 1.0;
    }
  }
  // 468 frames of 12 scenes, whose errors last for some 5 frames: a standard deviation of 0.06.
  EXPECT_NEAR(world / count, 1.0, 0.25);
  EXPECT_NEAR(relative / count, 1.0, 0.25);
  EXPECT_NEAR(ahead / count, 1.0, 0.25);
}

TEST(MovingSlam, ACorrectionOfTheCameraTakesTheObjectAlong) {
  // The camera's start is wrong by 10 cm, which a landmark of known place tells in the second
  // frame.
  const SE3d camera = testing::scene_camera();
  const SE3d wrong = SE3d(SO3d(), {0.1, 0.0, 0.0}) * camera;
  const SE3d landmark = pose(0, 0, 0, 0.1, 0.0, 0.0);
  const SE3d truth = pose(0.2, 0, 0.3, -0.1, 0.05, 0.0);
  std::vector<ObjectModel> models{{.id = "landmark", .noise = ray_noise()}, hand()};
  models[0].prior = ObjectPrior{PoseDensity(landmark, isotropic(0.01, 1e-4)), 1.0};
  MultiObjectSlam slam({wrong, isotropic(5.0, 0.1)}, models, plain_slam(),
                       {.noise = {isotropic(0.01, 1e-4)}});
  slam.step({.detections = {std::nullopt, camera.inverse() * truth}});
  const FrameEstimate after =
      slam.step({.dt = 0.01, .motion = SE3d(), .detections = {camera.inverse() * landmark, {}}});
  const double moved = (after.camera.mean().translation() - wrong.translation()).norm();
  EXPECT_GT(moved, 0.05);
  EXPECT_LT(
      (after.relative[1]->mean().translation() - (camera.inverse() * truth).translation()).norm(),
      0.005);
}

TEST(MovingSlam, ObjectsOfAClassAreFollowedWhileTheyMove) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    const SymmetryGroup turn({pose(0, 0, std::numbers::pi, 0, 0, 0)});
    const DetectorNoise noise = SceneNoise{}.noise();
    std::vector<ObjectModel> models;
    for (const char* id : {"bolt.0", "bolt.1", "bolt.2"})
      models.push_back({.id = id,
                        .noise = noise,
                        .symmetries = turn,
                        .class_id = "bolt",
                        .motion = calm_and_agile({.acceleration_sds = testing::sds(0.3, 0.1)})});
    std::vector<testing::MovingScene> bolts;
    for (std::uint64_t j = 0; j < 2; ++j) {
      bolts.emplace_back(10 * seed + j, noise);
      bolts.back().truth = pose(0.3, 0.2, 0.5, j == 0 ? -0.12 : 0.12, 0.0, 0.0);
      bolts.back().twist << 0, 0, 0.3, 0.03, 0.02, 0.0;
    }
    MultiObjectSlam slam({testing::scene_camera(), isotropic(0.01, 1e-4)}, models, {},
                         {.model = MotionModel::still});
    std::vector<std::size_t> taken(2);
    for (int k = 0; k < 40; ++k) {
      FrameInput input{.dt = 0.1};
      for (std::size_t j = 0; j < 2; ++j) {
        if (k > 0)
          bolts[j].advance(ConstantVelocityMotion{.acceleration_sds = testing::sds(0.1, 0.02)},
                           0.1);
        const SE3d seen =
            k % 2 == 0 ? bolts[j].inlier() : bolts[j].inlier() * turn.elements().back();
        input.candidates.push_back({"bolt", seen, 0.9});
      }
      const FrameEstimate now = slam.step(input);
      for (std::size_t j = 0; j < 2; ++j) {
        const CandidateReport& report = now.report.candidates[j];
        ASSERT_TRUE(report.object.has_value()) << k;
        EXPECT_EQ(report.status, k == 0 ? CandidateStatus::fresh : CandidateStatus::assigned);
        if (k == 0) taken[j] = *report.object;
        EXPECT_EQ(*report.object, taken[j]) << k;
        EXPECT_EQ(now.motion_models[taken[j]].size(), 2U);
      }
    }
  }
}

// After a month a constant velocity leaves the object anywhere: it is lost, and found again by its
// class and by its name.
TEST(MovingSlam, WhatWasNotSeenForAMonthIsFoundAgain) {
  testing::MovingScene bolt(5, SceneNoise{}.noise());
  ObjectModel model{.id = "bolt.0",
                    .noise = SceneNoise{}.noise(),
                    .class_id = "bolt",
                    .motion = {.models = {ConstantVelocityMotion{testing::sds(0.3, 0.3)}}}};
  for (const bool by_class : {true, false}) {
    MultiObjectSlam slam({testing::scene_camera(), isotropic(0.01, 1e-4)}, {model}, {},
                         {.model = MotionModel::still});
    for (const double dt : {0.1, 0.1, 2.6e6, 0.1}) {
      FrameInput input{.dt = dt};
      if (by_class) input.candidates.push_back({"bolt", bolt.inlier(), 0.9});
      if (!by_class) input.detections = {bolt.inlier()};
      const FrameEstimate now = slam.step(input);
      ASSERT_TRUE(now.objects[0].has_value());
      EXPECT_LT((now.objects[0]->mean().translation() - bolt.truth.translation()).norm(), 0.1);
    }
    const FrameEstimate alone = slam.step({.dt = 2.6e6});
    EXPECT_EQ(alone.healths[0], TrackHealth::lost);
    EXPECT_TRUE(alone.register_again[0]);
    EXPECT_TRUE(alone.objects[0]->covariance().allFinite());
    const std::string bytes = state_bytes(slam);
    EXPECT_EQ(state_bytes(std::get<MultiObjectSlam>(slam_of_state(bytes))), bytes);
  }
}

TEST(MovingSlam, AnInstanceThatWasSeenOnceGivesWayToAnother) {
  ObjectModel bolt = hand();
  bolt.class_id = "bolt";
  MultiObjectSlam slam({testing::scene_camera(), isotropic(0.01, 1e-4)}, {bolt});
  const SE3d here = pose(0, 0, 0, 0, 0, 0.8);
  const SE3d there = pose(0, 0, 0, 0.4, 0, 0.8);
  EXPECT_EQ(slam.step({.candidates = {{"bolt", here, 0.9}}}).report.candidates[0].status,
            CandidateStatus::fresh);
  const FrameEstimate next =
      slam.step({.dt = 0.1, .motion = SE3d(), .candidates = {{"bolt", there, 0.9}}});
  EXPECT_TRUE(next.report.candidates[0].recycled);
  EXPECT_EQ(slam.detections(0), 1U);
  EXPECT_NEAR(next.relative[0]->mean().translation().x(), 0.4, 0.02);
  EXPECT_EQ(slam.hypotheses(0).size(), 1U);
}

TEST(MovingSlam, AnObjectOnSightMayMove) {
  ObjectModel model = hand(calm_and_agile());
  MultiObjectSlamSettings settings;
  settings.on_sight = model;
  MultiObjectSlam slam({testing::scene_camera(), isotropic(0.01, 1e-4)}, static_models(), settings,
                       {}, true);
  Observation seen = observation_of(pose(0, 0, 0, 0, 0, 0.8));
  seen.object = "cart";
  slam.step({});
  const FrameEstimate now = slam.step({.dt = 0.1, .motion = SE3d(), .observations = {seen}});
  EXPECT_EQ(now.object("cart").status, DetectionStatus::started);
  EXPECT_EQ(now.object("cart").motion_models.size(), 2U);
  EXPECT_EQ(now.object("cart").alternatives.size(), 1U);
  EXPECT_FALSE(now.pose_indices[2]);
  EXPECT_TRUE(slam.moving().has(2));
}

TEST(MovingSlam, ThePredictionOfAnObjectGoesOnWithIt) {
  MultiObjectSlam slam({testing::scene_camera(), isotropic(0.01, 1e-4)},
                       {hand(), {.id = "box", .noise = ray_noise()}});
  EXPECT_FALSE(slam.object_at(0, 0.1));
  const SE3d at = pose(0, 0, 0, 0, 0, 0.8);
  FrameEstimate now{.camera = start_near(at), .objects = {}, .relative = {}, .pose_indices = {}};
  for (int k = 0; k < 30; ++k)
    now = slam.step({.dt = 0.1,
                     .motion = SE3d(),
                     .detections = {SE3d(SO3d(), {0.02 * k - 0.3, 0.0, 0.8}), at}});
  // 0.2 m/s along the camera's x.
  const Eigen::Vector3d velocity = now.twists[0]->mean.tail<3>();
  EXPECT_NEAR(velocity.x(), 0.2, 0.02);
  const PoseDensity later = *slam.object_at(0, 0.5);
  EXPECT_NEAR(later.mean().translation().x() - now.objects[0]->mean().translation().x(), 0.1, 0.02);
  EXPECT_GT(later.covariance().trace(), 2.0 * now.objects[0]->covariance().trace());
  expect_same_bits(*slam.object_at(0, 0.0), *now.objects[0]);
  expect_same_bits(*slam.object_at(1, 0.5), *now.objects[1]);
  EXPECT_NE(thrown_message([&] { (void)slam.object_at(0, -1.0); }).find("dt is -1"),
            std::string::npos);
  EXPECT_NE(thrown_message([&] { (void)slam.object_at(2, 0.1); }).find("there is no object 2"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix
