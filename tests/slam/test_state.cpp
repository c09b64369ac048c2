// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/state.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "filter/multi_object_scene.hpp"
#include "posemix/testing/expect.hpp"
#include "state_scene.hpp"

namespace posemix {
namespace {

using testing::give;
using testing::RichScene;
using testing::StampedInput;
using testing::thrown_message;

template <class Slam>
Slam reloaded(const Slam& slam) {
  const std::string bytes = state_bytes(slam);
  Slam loaded = std::get<Slam>(slam_of_state(bytes));
  EXPECT_EQ(state_bytes(loaded), bytes);
  return loaded;
}

/// Every number of two estimates, but for measured times.
void expect_same_estimates(const FrameEstimate& a, const FrameEstimate& b) {
  EXPECT_EQ(a.camera.mean().matrix(), b.camera.mean().matrix());
  EXPECT_EQ(a.camera.covariance(), b.camera.covariance());
  ASSERT_EQ(*a.ids, *b.ids);
  for (std::size_t j = 0; j < a.objects.size(); ++j) {
    ASSERT_EQ(a.objects[j].has_value(), b.objects[j].has_value());
    EXPECT_EQ(a.existences[j], b.existences[j]);
    EXPECT_EQ(a.healths[j], b.healths[j]);
    EXPECT_EQ(a.register_again[j], b.register_again[j]);
    EXPECT_EQ(a.motion_models[j], b.motion_models[j]);
    EXPECT_EQ(a.report.statuses[j], b.report.statuses[j]);
    if (!a.objects[j]) continue;
    EXPECT_EQ(a.objects[j]->mean().matrix(), b.objects[j]->mean().matrix());
    EXPECT_EQ(a.objects[j]->covariance(), b.objects[j]->covariance());
    EXPECT_EQ(a.relative[j]->covariance(), b.relative[j]->covariance());
    EXPECT_EQ(a.mode_probabilities[j], b.mode_probabilities[j]);
    ASSERT_EQ(a.alternatives.size(), b.alternatives.size());
    if (a.alternatives.empty()) continue;
    ASSERT_EQ(a.alternatives[j].size(), b.alternatives[j].size());
    for (std::size_t h = 0; h < a.alternatives[j].size(); ++h) {
      EXPECT_EQ(a.alternatives[j][h].id, b.alternatives[j][h].id);
      EXPECT_EQ(a.alternatives[j][h].probability, b.alternatives[j][h].probability);
      EXPECT_EQ(a.alternatives[j][h].pose.matrix(), b.alternatives[j][h].pose.matrix());
    }
  }
}

/// A session, and after a jump of the clock another one.
std::vector<StampedInput> two_sessions() {
  RichScene scene(1);
  std::vector<StampedInput> inputs = scene.session(13.0);
  for (StampedInput& input : scene.session(2.0)) inputs.push_back(std::move(input));
  return inputs;
}

TEST(State, WhatWasStoppedGoesOnAsIfItWasNot) {
  const std::vector<StampedInput> inputs = two_sessions();
  std::vector<std::size_t> cuts;
  for (const double part : {0.0, 0.004, 0.03, 0.1, 0.2, 0.5, 0.8, 0.86, 0.88, 0.95, 1.0})
    cuts.push_back(static_cast<std::size_t>(part * static_cast<double>(inputs.size())));
  StampedSlam undisturbed = RichScene::slam();
  std::vector<StampedSlam> stopped;
  std::size_t largest_hypotheses = 0;
  std::size_t largest_waiting = 0;
  for (std::size_t k = 0; k <= inputs.size(); ++k) {
    if (std::ranges::count(cuts, k) > 0) stopped.push_back(reloaded(undisturbed));
    if (k == inputs.size()) break;
    const StampAdmission expected = give(undisturbed, inputs[k]);
    for (StampedSlam& slam : stopped) EXPECT_EQ(give(slam, inputs[k]), expected);
    largest_waiting = std::max(largest_waiting, undisturbed.waiting());
    if (k % 40 != 0) continue;
    const auto estimate = undisturbed.estimate();
    for (StampedSlam& slam : stopped) {
      const auto& own = slam.estimate();
      ASSERT_EQ(own.has_value(), estimate.has_value());
      if (!own) continue;
      EXPECT_EQ(own->stamp_s, estimate->stamp_s);
      expect_same_estimates(own->estimate, estimate->estimate);
      largest_hypotheses = std::max(largest_hypotheses, slam.slam().hypotheses(0).size());
    }
  }
  const std::string bytes = state_bytes(undisturbed);
  for (StampedSlam& slam : stopped) EXPECT_EQ(state_bytes(slam), bytes);
  expect_same_estimates(undisturbed.finish()->estimate, stopped.front().finish()->estimate);
  // The recording had what it is for.
  EXPECT_EQ(stopped.size(), cuts.size());
  EXPECT_GT(largest_hypotheses, 1U);
  EXPECT_GT(largest_waiting, 0U);
  EXPECT_GT(undisturbed.counts().replayed, 200U);
  EXPECT_EQ(undisturbed.counts().resets, 1U);
}

TEST(State, TheRichRecordingHasWhatAStateMayHold) {
  StampedSlam slam = RichScene::slam();
  bool was_deleted = false;
  bool was_held = false;
  bool was_put_down = false;
  std::size_t begun = 0;
  const std::vector<StampedInput> inputs = RichScene(1).session(13.0);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    give(slam, inputs[k]);
    if (k % 10 != 0 || !slam.estimate()) continue;
    const FrameEstimate& now = slam.estimate()->estimate;
    const bool third = now.object("nut-3").world.has_value();
    was_deleted = was_deleted || (begun > 0 && !third);
    begun += third ? 1 : 0;
    was_held = was_held || (now.object("tool").world && now.object("tool").motion_models[1] > 0.9);
    was_put_down = was_put_down || (now.object("tray").world &&
                                    now.object("tray").world->mean().translation().x() < 0.0);
  }
  const MultiObjectSlam& tracker = slam.slam();
  EXPECT_TRUE(was_deleted);
  EXPECT_TRUE(was_held);
  EXPECT_TRUE(was_put_down);
  EXPECT_EQ(tracker.objects().back().id, "lid");
  EXPECT_LT(tracker.estimated_cameras()[1].covariance->trace(),
            tracker.cameras()[1].covariance->trace());
  EXPECT_NE(tracker.filter().noise_scale(0), Vector6d::Ones());
  EXPECT_GT(tracker.hypotheses(0).size(), 1U);
}

/// Frames of a camera that circles objects, of which more are seen than have active blocks.
template <class Change>
void expect_same_after_reload(const MotionSettings& motion, std::size_t objects, int frames,
                              const MultiObjectSlamSettings& settings, const Change& change) {
  testing::OrbitScene scene(3, objects, 0.05, 1e-3);
  std::vector<ObjectModel> models;
  for (std::size_t j = 0; j < objects; ++j) models.push_back({.id = fmt::format("object-{}", j)});
  MultiObjectSlam slam(PoseDensity(scene.camera, testing::isotropic(0.1, 0.002)), models, settings,
                       motion);
  std::vector<MultiObjectSlam> stopped{reloaded(slam)};
  for (int k = 0; k < frames; ++k) {
    FrameInput input{.dt = 0.1};
    if (k > 0) input.motion = scene.advance();
    input.detections.resize(objects);
    for (std::size_t j = 0; j < objects; ++j)
      if ((j + static_cast<std::size_t>(k)) % 5 == 0 || objects < 5)
        input.detections[j] = scene.detect(j, 0.3, 0.1);
    change(input, scene);
    const FrameEstimate expected = slam.step(input);
    for (MultiObjectSlam& one : stopped) expect_same_estimates(one.step(input), expected);
    if (k == 1 || k == frames / 2) stopped.push_back(reloaded(slam));
  }
  for (const MultiObjectSlam& one : stopped) {
    EXPECT_EQ(state_bytes(one), state_bytes(slam));
    EXPECT_EQ(one.estimate().covariance(), slam.estimate().covariance());
  }
}

TEST(State, PassiveLandmarksGoOnAsTheyWere) {
  expect_same_after_reload({}, 40, 40, {}, [](const FrameInput&, const auto&) {});
}

TEST(State, ACameraWithoutOdometryGoesOn) {
  expect_same_after_reload({.model = MotionModel::constant_velocity}, 3, 30, {},
                           [](FrameInput& input, const auto&) { input.motion.reset(); });
}

TEST(State, ACameraThatIsGivenGoesOn) {
  expect_same_after_reload({.model = MotionModel::given}, 3, 30, {},
                           [](FrameInput& input, const auto& scene) {
                             input.motion.reset();
                             if (scene.frame % 4 != 3) input.camera = scene.camera;
                           });
}

TEST(State, GlobalHypothesesGoOn) {
  // Half of the detections are flips, and the camera is not certain: nothing tells the modes apart.
  testing::OrbitScene scene(5, 2, 1.0, 0.02);
  MultiObjectSlamSettings settings;
  settings.filter = testing::plain_settings();
  settings.filter.split_loss = 1e-4;
  const std::vector<ObjectModel> models = {{.id = "box", .noise = testing::ray_noise()},
                                           {.id = "mug", .noise = testing::ray_noise()}};
  MultiObjectSlam slam(PoseDensity(scene.camera, testing::isotropic(3.0, 0.05)), models, settings,
                       {.noise = {scene.q, NoisePer::frame}});
  std::vector<MultiObjectSlam> stopped;
  std::size_t most = 1;
  for (int k = 0; k < 30; ++k) {
    FrameInput input{.dt = 0.1};
    if (k > 0) input.motion = scene.advance();
    input.detections = {scene.detect(0, 0.5, 0.0), scene.detect(1, 0.5, 0.0)};
    const FrameEstimate expected = slam.step(input);
    for (MultiObjectSlam& one : stopped) expect_same_estimates(one.step(input), expected);
    const std::size_t states = slam.filter().camera_mixture().size();
    if (states > most || k == 20) stopped.push_back(reloaded(slam));
    most = std::max(most, states);
  }
  EXPECT_GT(most, 1U);
  for (const MultiObjectSlam& one : stopped) EXPECT_EQ(state_bytes(one), state_bytes(slam));
}

TEST(State, OfObjectSlamIsThatOfItsTracker) {
  const PoseDensity camera(SE3d(), testing::isotropic(1.0, 0.01));
  ObjectSlam slam(camera, {{.id = "mug"}});
  slam.step({.detections = {testing::pose(0.1, 0.2, 0.3, 0.0, 0.0, 0.5)}});
  ObjectSlam loaded(std::get<MultiObjectSlam>(slam_of_state(state_bytes(slam))));
  const FrameInput next{.dt = 0.1, .detections = {testing::pose(0.1, 0.2, 0.31, 0.0, 0.01, 0.5)}};
  expect_same_estimates(slam.step(next), loaded.step(next));
  const ObjectSlam particles(camera, {{.id = "mug"}}, {.tracker = ParticleFilterSettings{}});
  EXPECT_EQ(thrown_message([&] { state_bytes(particles); }),
            "the tracker has no state that can be saved, expected the multi-object filter");
}

TEST(State, AnObjectThatIsAddedIsOneOfTheOthers) {
  const PoseDensity camera(SE3d(), testing::isotropic(0.1, 0.001));
  const SE3d mug = testing::pose(0.1, 0.2, 0.3, 0.0, 0.0, 0.5);
  MultiObjectSlam slam(camera, {{.id = "mug"}});
  slam.step({.detections = {mug}});
  ObjectModel box{.id = "box"};
  box.prior = ObjectPrior{PoseDensity(mug, testing::isotropic(1.0, 0.01)), 0.9};
  EXPECT_EQ(slam.add(box), 1U);
  EXPECT_EQ(slam.hypotheses(1).size(), 1U);
  MultiObjectSlam loaded = reloaded(slam);
  const FrameInput next{.dt = 0.1, .detections = {mug, mug}};
  expect_same_estimates(slam.step(next), loaded.step(next));
  EXPECT_EQ(thrown_message([&] { slam.add({.id = "mug"}); }),
            "there is an object 'mug' already, expected another id");
  EXPECT_THROW(slam.add({.id = "cup", .independent_start = Matrix6d::Identity()}), InvalidInput);
  EXPECT_EQ(slam.objects().size(), 2U);
}

/// A session far from the origin of the world, with an object that is known there; or one that
/// drove there from an uncertain start. Models are judged by themselves.
TEST(State, OfSessionsFarFromTheOriginAreRestoredAndTakeModels) {
  for (const bool has_prior : {true, false}) {
    testing::OrbitScene scene(1, 2, 0.05, 1e-3);
    const SE3d far(SO3d(), {has_prior ? 5e5 : 0.0, 0.0, 0.0});
    const Matrix6d sharp = testing::isotropic(0.4, 0.001);
    const DetectorNoise noise({{.weight = 0.9, .covariance = sharp}},
                              {.weight = 0.1, .volume_m3 = 1.0});
    std::vector<ObjectModel> models{{.id = "box", .noise = noise}, {.id = "mug", .noise = noise}};
    if (has_prior) {
      const SE3d known = far * scene.truth[0];
      models[0].prior =
          ObjectPrior{{known, far.adjoint_congruence(testing::isotropic(0.5, 0.005))}, 0.9};
    }
    const Matrix6d start = testing::isotropic(has_prior ? 0.5 : 100.0, 0.005);
    MultiObjectSlam slam({far * scene.camera, far.adjoint_congruence(start)}, models);
    for (int k = 0; k < 20; ++k) {
      FrameInput input{.dt = 0.1, .motion = scene.advance()};
      for (std::size_t j = 0; j < 2; ++j) {
        input.detections.emplace_back(scene.camera.inverse() * scene.truth[j] *
                                      SE3d::exp(testing::draw(sharp, scene.stream)));
      }
      slam.step(input);
    }
    for (int k = 0; !has_prior && k < 100; ++k)
      slam.step({.dt = 1.0, .motion = SE3d(SO3d(), {0.0, 0.0, 1e4}), .detections = {{}, {}}});
    MultiObjectSlam loaded = reloaded(slam);
    EXPECT_EQ(loaded.add({.id = "new", .noise = noise}), 2);
    EXPECT_EQ(slam.add({.id = "new", .noise = noise}), 2);
  }
}

TEST(State, ConfigurationsDifferInWhatIsNamed) {
  const StampedSlam slam = RichScene::slam();
  EXPECT_TRUE(configuration_differences(reloaded(slam), slam).empty());
  std::vector<ObjectModel> models = RichScene::models();
  models[1].noise = testing::gaussian_noise();
  MultiObjectSlamSettings settings = RichScene::settings();
  settings.existence.lifetime_s = 1e4;
  const StampedSlam other(PoseDensity(SE3d(), testing::isotropic(1.0, 0.1)), models, settings,
                          {.period_s = 0.2}, {.checkpoints = 7});
  EXPECT_EQ(configuration_differences(slam, other),
            (std::vector<std::string>{"object 'bottle'", "settings", "motion", "record_hypotheses",
                                      "stamped"}));
  // An object that was met on the way is no difference.
  StampedSlam later = RichScene::slam();
  for (const StampedInput& input : RichScene(1).session(2.0)) give(later, input);
  ASSERT_GT(later.estimate()->estimate.objects.size(), RichScene::models().size());
  EXPECT_TRUE(configuration_differences(later, slam).empty());
  // One that was declared is one in both directions.
  std::vector<ObjectModel> fewer = RichScene::models();
  const std::string gone = fewer.back().id;
  fewer.pop_back();
  const StampedSlam without(PoseDensity(SE3d(), testing::isotropic(1.0, 0.1)), fewer,
                            RichScene::settings());
  const auto differences = configuration_differences(slam, without);
  EXPECT_EQ(std::ranges::count(differences, "object '" + gone + "'"), 1);
}

}  // namespace
}  // namespace posemix
