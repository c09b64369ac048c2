// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "filter/moving_object_scene.hpp"
#include "filter/multi_object_scene.hpp"
#include "posemix/slam/run.hpp"
#include "posemix/slam/smoothing.hpp"
#include "posemix/slam/stamped_slam.hpp"
#include "posemix/testing/expect.hpp"

/// Objects that move beside static ones.
namespace posemix {
namespace {

using testing::isotropic;
using testing::nees_of;
using testing::OrbitScene;
using testing::plain_settings;
using testing::pose;
using testing::ray_noise;
using testing::SceneNoise;
using testing::thrown_message;

MotionModels of(const ObjectMotion& motion) { return {.models = {motion}}; }

const ConstantVelocityMotion kMoves{.acceleration_sds = testing::sds(0.3, 0.1), .break_rate = 0.0};

/// A camera that circles two static objects and one that moves.
struct MovingOrbit : OrbitScene {
  explicit MovingOrbit(std::uint64_t seed)
      : OrbitScene(seed, 2, 0.05, 1e-3), moving(seed, SceneNoise{.clutter = 0.02}.noise()) {
    moving.truth = pose(0.3, 0.2, 0.5, 0.0, 0.15, 0.05);
    moving.camera = camera;
  }

  SE3d next() {
    const SE3d motion = advance();
    moving.advance(kMoves, 0.1);
    moving.camera = camera;
    return motion;
  }

  testing::MovingScene moving;
};

std::vector<ObjectModel> static_models() {
  return {{.id = "box", .noise = ray_noise()}, {.id = "mug", .noise = ray_noise()}};
}

ObjectModel hand(const MotionModels& motion = of(kMoves)) {
  return {.id = "hand", .noise = SceneNoise{.clutter = 0.02}.noise(), .motion = motion};
}

MultiObjectSlamSettings plain() { return {.filter = plain_settings()}; }

PoseDensity start(const SE3d& camera) { return {camera, isotropic(0.3, 0.005)}; }

void expect_same(const PoseDensity& a, const PoseDensity& b) {
  EXPECT_EQ(a.mean().matrix(), b.mean().matrix());
  EXPECT_EQ(a.covariance(), b.covariance());
}

TEST(MovingSlam, AMovingObjectLeavesCameraAndStaticObjectsToTheLastBit) {
  MovingOrbit scene(1);
  std::vector<ObjectModel> models = static_models();
  models.insert(models.begin() + 1, hand());
  MultiObjectSlam with(start(scene.camera), models);
  MultiObjectSlam without(start(scene.camera), static_models());
  for (int k = 0; k < 60; ++k) {
    FrameInput input{.dt = 0.1};
    if (k > 0) input.motion = scene.next();
    input.detections = {scene.detect(0, 0.1, 0.1), scene.moving.inlier(),
                        scene.detect(1, 0.1, 0.1)};
    const FrameEstimate a = with.step(input);
    input.detections.erase(input.detections.begin() + 1);
    const FrameEstimate b = without.step(input);
    expect_same(a.camera, b.camera);
    expect_same(*a.objects[0], *b.objects[0]);
    expect_same(*a.objects[2], *b.objects[1]);
    expect_same(*a.relative[2], *b.relative[1]);
  }
  EXPECT_FALSE(with.pose_index(1));
  EXPECT_EQ(with.estimate().mean().size(), without.estimate().mean().size());
  EXPECT_EQ(with.detections(1), 60U);
}

TEST(MovingSlam, ModelsThatAreAllStaticAreTheJointFilter) {
  MovingOrbit scene(2);
  std::vector<ObjectModel> models = static_models();
  models[0].motion.models = {StaticMotion{}, StaticMotion{}};
  MultiObjectSlam several(start(scene.camera), models);
  MultiObjectSlam one(start(scene.camera), static_models());
  for (int k = 0; k < 20; ++k) {
    FrameInput input{.dt = 0.1};
    if (k > 0) input.motion = scene.next();
    input.detections = {scene.detect(0, 0.1, 0.1), scene.detect(1, 0.1, 0.1)};
    const FrameEstimate a = several.step(input);
    const FrameEstimate b = one.step(input);
    expect_same(*a.objects[0], *b.objects[0]);
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
    MultiObjectSlamSettings settings = plain();
    settings.moving = testing::plain_moving_settings();
    MotionSettings motion;
    motion.noise = {scene.q, NoisePer::frame};
    MultiObjectSlam slam(start(stated), models, settings, motion);
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
  MultiObjectSlam slam({wrong, isotropic(5.0, 0.1)}, models, plain(),
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

TEST(MovingSlam, AnAttachedObjectMovesWithItsFrame) {
  MultiObjectSlamSettings settings;
  settings.frames = {"gripper"};
  MultiObjectSlam slam({testing::scene_camera(), isotropic(0.01, 1e-4)},
                       {hand(of(AttachedMotion{}))}, settings);
  const SE3d gripper = pose(0.1, 0.2, 0.0, 0.1, 0.0, 0.1);
  const SE3d seen = pose(0, 0, 0, 0, 0, 0.8);
  EXPECT_NE(
      thrown_message([&] { slam.step({.detections = {seen}}); }).find("'gripper' had no pose"),
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

TEST(MovingSlam, ThePredictionOfAnObjectGoesOnWithIt) {
  MultiObjectSlam slam({testing::scene_camera(), isotropic(0.01, 1e-4)},
                       {hand(), {.id = "box", .noise = ray_noise()}});
  EXPECT_FALSE(slam.object_at(0, 0.1));
  const SE3d at = pose(0, 0, 0, 0, 0, 0.8);
  FrameEstimate now{.camera = start(at), .objects = {}, .relative = {}, .pose_indices = {}};
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
  expect_same(*slam.object_at(0, 0.0), *now.objects[0]);
  expect_same(*slam.object_at(1, 0.5), *now.objects[1]);
  EXPECT_NE(thrown_message([&] { (void)slam.object_at(0, -1.0); }).find("dt is -1"),
            std::string::npos);
  EXPECT_NE(thrown_message([&] { (void)slam.object_at(2, 0.1); }).find("there is no object 2"),
            std::string::npos);
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
  expect_same(late.camera, expected.camera);
  expect_same(*late.objects[1], *expected.objects[1]);
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
  model.prior = ObjectPrior{start(SE3d())};
  EXPECT_NE(message(model).find("object 'hand': it moves and has a prior"), std::string::npos);
  EXPECT_NE(message(hand(of(AttachedMotion{.frame = 1})), {.frames = {"arm"}})
                .find("object 'hand': it may be held by frame 1"),
            std::string::npos);
  EXPECT_NE(message(hand({.models = {}})).find("no motion model"), std::string::npos);
  EXPECT_NE(message(hand(of(RandomWalkMotion{.break_rate = -1.0}))).find("object 'hand': "),
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
              FixedLagSmoother(camera, {hand()}, {}, {.lag_frames = 2});
            }).find("smoothing: object 'hand' moves"),
            std::string::npos);
  MultiObjectSlam slam(camera, {hand()});
  EXPECT_NE(
      thrown_message([&] { slam.step({.frames = {KnownFrame{}}}); }).find("1 poses of frames"),
      std::string::npos);
}

}  // namespace
}  // namespace posemix
