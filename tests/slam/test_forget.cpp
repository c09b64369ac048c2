// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/slam/object_slam.hpp"
#include "posemix/testing/expect.hpp"
#include "state_scene.hpp"

/// Single objects that are forgotten.
namespace posemix {
namespace {

using testing::give;
using testing::isotropic;
using testing::pose;
using testing::RichScene;
using testing::StampedInput;
using testing::thrown_message;

const SE3d kForgottenMug = pose(0.1, 0.2, 0.3, 0.0, 0.0, 0.6);
const SE3d kBefore = pose(0.3, 0.0, 0.1, 0.2, 0.0, 0.7);
const SE3d kAfter = pose(0.0, 0.4, 0.1, -0.2, 0.1, 0.8);

Observation seen_at(const std::string& object, const SE3d& place, double stamp_s = 0.0) {
  Observation observation = observation_of(place);
  observation.object = object;
  observation.stamp_s = stamp_s;
  return observation;
}

/// Numbers of two estimates of one object, up to what a camera known to 1 um makes of them.
void expect_near(const MultiObjectSlam& a, const MultiObjectSlam& b, std::size_t object) {
  const auto& first = a.hypotheses(object);
  const auto& second = b.hypotheses(object);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t h = 0; h < first.size(); ++h) {
    EXPECT_LT((first[h].pose * second[h].pose.inverse()).log().norm(), 1e-5);
    EXPECT_LT((first[h].covariance - second[h].covariance).norm(),
              1e-3 * first[h].covariance.norm());
    EXPECT_NEAR(first[h].probability, second[h].probability, 1e-6);
    EXPECT_EQ(first[h].detections, second[h].detections);
  }
  ASSERT_EQ(a.existence(object).has_value(), b.existence(object).has_value());
  if (a.existence(object)) {
    EXPECT_NEAR(*a.existence(object), *b.existence(object), 1e-6);
  }
  EXPECT_EQ(a.detections(object), b.detections(object));
}

/// An object of a kind, seen at one place and forgotten, then seen at another one, against
/// one that was never seen at the first.
void expect_as_never_seen(ObjectModel model) {
  const Matrix6d certain = isotropic(1e-4, 1e-6);
  const MotionSettings still{.model = MotionModel::still};
  MultiObjectSlam forgetful(PoseDensity(SE3d(), certain), {{.id = "mug"}, model}, {}, still);
  MultiObjectSlam never = forgetful;
  const auto step = [](MultiObjectSlam& slam, const ObjectModel& of, const SE3d* place) {
    FrameInput input{.dt = 0.1, .observations = {seen_at("mug", kForgottenMug)}};
    if (place != nullptr) {
      input.observations.push_back(seen_at(of.class_id.empty() ? of.id : "", *place));
      input.observations.back().class_id = of.class_id;
    }
    return slam.step(input);
  };
  FrameEstimate last = step(never, model, nullptr);
  step(forgetful, model, &kBefore);
  for (int k = 0; k < 6; ++k) {
    step(never, model, nullptr);
    last = step(forgetful, model, &kBefore);
  }
  ASSERT_TRUE(last.objects[1]);
  forgetful.forget(1, last);
  EXPECT_FALSE(last.objects[1]);
  EXPECT_FALSE(last.relative[1]);
  EXPECT_FALSE(last.existences[1]);
  EXPECT_FALSE(last.pose_indices[1]);
  EXPECT_EQ(last.healths[1], TrackHealth::none);
  EXPECT_TRUE(forgetful.hypotheses(1).empty());
  EXPECT_FALSE(forgetful.object_at(1, 0.0));
  EXPECT_FALSE(forgetful.existence(1));
  EXPECT_EQ(forgetful.detections(1), 0U);
  expect_near(forgetful, never, 0);
  for (int k = 0; k < 4; ++k) {
    const FrameEstimate again = step(forgetful, model, &kAfter);
    EXPECT_EQ(again.report.statuses[1], step(never, model, &kAfter).report.statuses[1]);
    expect_near(forgetful, never, 0);
    expect_near(forgetful, never, 1);
  }
}

TEST(Forget, AnObjectIsAsOneThatWasNeverSeen) { expect_as_never_seen({.id = "box"}); }

TEST(Forget, OneOfAClassIsAsOneThatWasNeverSeen) {
  expect_as_never_seen({.id = "nut-1", .class_id = "nut"});
}

TEST(Forget, OneThatIsPutDownElsewhereIsAsOneThatWasNeverSeen) {
  ObjectModel tray{.id = "tray"};
  tray.motion.models = {PutDownMotion{.jump_rate = 0.05}};
  expect_as_never_seen(tray);
}

TEST(Forget, OneThatMovesIsAsOneThatWasNeverSeen) {
  expect_as_never_seen({.id = "hand", .motion = calm_and_agile(ConstantVelocityMotion{})});
}

TEST(Forget, AKnownPlaceIsForgottenToo) {
  ObjectModel shelf{.id = "shelf"};
  shelf.prior = ObjectPrior{PoseDensity(kBefore, isotropic(1.0, 0.01)), 0.9};
  MultiObjectSlam slam(PoseDensity(SE3d(), isotropic(0.1, 0.001)), {shelf}, {},
                       {.model = MotionModel::still});
  EXPECT_EQ(slam.existence(0), 1.0);
  slam.forget(0);
  EXPECT_FALSE(slam.existence(0));
  EXPECT_FALSE(slam.step({.dt = 0.1}).objects[0]);
  const FrameEstimate anew = slam.step({.dt = 0.1, .detections = {kAfter}});
  EXPECT_EQ(anew.report.statuses[0], DetectionStatus::started);
  EXPECT_LT((anew.objects[0]->mean() * kAfter.inverse()).log().norm(), 1e-9);
  EXPECT_EQ(slam.hypotheses(0).size(), 1U);
}

using ObjectMixture = Mixture<ConcentratedGaussian<SE3d>>;

/// Of all that has any weight, up to the order of sums.
void expect_same_components(const ObjectMixture& now, const ObjectMixture& then, const char* id) {
  const auto weighty = [](const ObjectMixture& places) {
    std::vector<Component<ConcentratedGaussian<SE3d>>> list = places.components();
    std::erase_if(list, [](const auto& one) { return one.log_weight < -100.0; });
    return list;
  };
  const auto a = weighty(now);
  const auto b = weighty(then);
  ASSERT_EQ(a.size(), b.size()) << id;
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_NEAR(a[k].log_weight, b[k].log_weight, 1e-12) << id;
    EXPECT_LT((a[k].density.mean().matrix() - b[k].density.mean().matrix()).norm(), 1e-12) << id;
    EXPECT_LT((a[k].density.covariance() - b[k].density.covariance()).norm(), 1e-12) << id;
  }
}

TEST(Forget, AllElseStaysAsItIs) {
  StampedSlam stamped = RichScene::slam();
  for (const StampedInput& input : RichScene(1).session(3.0)) give(stamped, input);
  stamped.finish();
  MultiObjectSlam slam = stamped.slam();
  const auto at = [&](const std::string& id) {
    const auto found = std::ranges::find(slam.objects(), id, &ObjectModel::id);
    return static_cast<std::size_t>(found - slam.objects().begin());
  };
  const MultiObjectSlam before = slam;
  const std::size_t poses = slam.estimate().mean().size();
  for (const char* id : {"box", "hand", "nut-2", "tray", "lid"}) slam.forget(at(id));
  // A global hypothesis of the weight e^-323 goes with the box: sums have one term less.
  const auto camera = slam.filter().camera();
  const auto camera_before = before.filter().camera();
  EXPECT_LT((camera.mean().matrix() - camera_before.mean().matrix()).norm(), 1e-15);
  EXPECT_LT((camera.covariance() - camera_before.covariance()).norm(), 1e-18);
  EXPECT_EQ(slam.estimated_cameras()[1].covariance, before.estimated_cameras()[1].covariance);
  int followers = 0;
  for (const char* id : {"mug", "bottle", "nut-1", "shelf", "tool"}) {
    const auto now = slam.hypotheses(at(id));
    const auto then = before.hypotheses(at(id));
    ASSERT_EQ(now.size(), then.size());
    if (!before.filter().hypotheses(at(id)).empty())  // one that moves has a filter of its own
      expect_same_components(slam.filter().object_mixture(at(id)),
                             before.filter().object_mixture(at(id)), id);
    for (std::size_t h = 0; h < now.size(); ++h) {
      EXPECT_NEAR(now[h].probability, then[h].probability, 1e-12) << id;
      const double pose = (now[h].pose.matrix() - then[h].pose.matrix()).norm();
      const double covariance = (now[h].covariance - then[h].covariance).norm();
      if (pose < 1e-12 && covariance < 1e-12) continue;  // up to the order of sums
      // One that leads in some global hypotheses and not in others is reported as it follows what
      // leads in all of them, forgotten objects too.
      ++followers;
      const Vector6d apart = (now[h].pose * then[h].pose.inverse()).log();
      EXPECT_LT(apart.dot(then[h].covariance.llt().solve(apart)), 1e-4) << id;
      EXPECT_LT(covariance, 0.01 * then[h].covariance.norm()) << id;
    }
    EXPECT_EQ(slam.existence(at(id)), before.existence(at(id)));
  }
  EXPECT_LE(followers, 1) << "of 14 hypotheses";
  // The hand was none of the joint Gaussian.
  EXPECT_EQ(slam.estimate().mean().size(), poses - 4);
  EXPECT_EQ(slam.objects().size(), before.objects().size());
  EXPECT_THROW(slam.forget(slam.objects().size()), InvalidInput);
}

/// A still body that sees the mug.
StampedSlam still_slam() {
  return {PoseDensity(SE3d(), isotropic(0.1, 0.001)),
          {{.id = "mug"}, {.id = "box"}},
          {},
          {.model = MotionModel::still}};
}

TEST(Forget, LateInputFromBeforeDoesNotBringItBack) {
  StampedSlam slam = still_slam();
  for (const double t : {1.0, 1.1, 1.2}) slam.add(seen_at("mug", kBefore, t));
  slam.add(seen_at("box", kForgottenMug, 1.2));
  EXPECT_TRUE(slam.estimate()->estimate.object("mug").world);
  EXPECT_EQ(slam.forget("mug"), StampAdmission::taken);
  EXPECT_FALSE(slam.estimate()->estimate.object("mug").world);
  EXPECT_TRUE(slam.estimate()->estimate.object("box").world);
  EXPECT_EQ(slam.estimate()->stamp_s, 1.2);
  // One that was taken before, and one at the same time.
  EXPECT_EQ(slam.add(seen_at("mug", kBefore, 1.15)), StampAdmission::replayed);
  slam.add(seen_at("mug", kBefore, 1.2));
  EXPECT_FALSE(slam.estimate()->estimate.object("mug").world);
  slam.add(seen_at("mug", kAfter, 1.3));
  const auto& anew = slam.estimate();
  ASSERT_TRUE(anew->estimate.object("mug").world);
  EXPECT_EQ(anew->estimate.object("mug").status, DetectionStatus::started);
  EXPECT_LT((anew->estimate.object("mug").world->mean() * kAfter.inverse()).log().norm(), 1e-9);
  EXPECT_EQ(slam.slam().detections(0), 1U);
  EXPECT_EQ(slam.slam().detections(1), 1U);
}

TEST(Forget, IsTakenInAtItsStampInWhateverOrder) {
  std::vector<StampedInput> inputs = RichScene(3).session(9.5);
  StampedSlam late = RichScene::slam();
  std::size_t forgets = 0;
  std::size_t replayed = 0;
  for (const StampedInput& input : inputs) {
    const StampAdmission admission = give(late, input);
    if (!std::holds_alternative<testing::StampedForget>(input)) continue;
    ++forgets;
    replayed += admission == StampAdmission::replayed ? 1 : 0;
  }
  std::ranges::stable_sort(inputs, {}, testing::stamp_of);
  StampedSlam sorted = RichScene::slam();
  bool was_gone = false;
  for (const StampedInput& input : inputs) {
    give(sorted, input);
    const auto* forget = std::get_if<testing::StampedForget>(&input);
    if (forget == nullptr || forget->id != "hand") continue;
    was_gone = !sorted.finish()->estimate.object("hand").world;
  }
  EXPECT_EQ(forgets, 6U);
  EXPECT_GT(replayed, 2U);
  EXPECT_TRUE(was_gone);
  const FrameEstimate a = late.finish()->estimate;
  const FrameEstimate b = sorted.finish()->estimate;
  for (std::size_t j = 0; j < a.objects.size(); ++j) {
    ASSERT_EQ(a.objects[j].has_value(), b.objects[j].has_value());
    EXPECT_EQ(a.existences[j], b.existences[j]);
    if (!a.objects[j]) continue;
    EXPECT_EQ(a.objects[j]->mean().matrix(), b.objects[j]->mean().matrix());
    EXPECT_EQ(a.objects[j]->covariance(), b.objects[j]->covariance());
  }
}

TEST(Forget, AStampOfItsOwnMayBeAheadOfTheInput) {
  // The robot takes the mug away at 1.3, where the last image is of 1.2 and one of 1.25 is to come.
  StampedSlam slam = still_slam();
  slam.add(seen_at("mug", kBefore, 1.2));
  slam.forget("mug", 1.3);
  slam.add(seen_at("mug", kBefore, 1.25));
  EXPECT_EQ(slam.estimate()->stamp_s, 1.3);
  EXPECT_FALSE(slam.estimate()->estimate.object("mug").world);
  EXPECT_EQ(slam.counts().taken, 2U);
  EXPECT_EQ(slam.counts().replayed, 1U);
  // What is older than the history is past.
  slam.add(seen_at("mug", kAfter, 5.0));
  EXPECT_EQ(slam.forget("mug", 2.0), StampAdmission::too_late);
  EXPECT_TRUE(slam.estimate()->estimate.object("mug").world);
}

TEST(Forget, WhatIsNotThereIsRefused) {
  StampedSlam slam = still_slam();
  EXPECT_EQ(slam.forget("mug"), StampAdmission::taken);  // of which nothing was seen
  EXPECT_FALSE(slam.estimate());
  EXPECT_EQ(thrown_message([&] { slam.forget("cup"); }),
            "there is no object 'cup', expected one of: mug, box");
  slam.add(seen_at("mug", kBefore, 20.0));
  EXPECT_THROW(slam.forget("mug", 1.0), InvalidInput);  // the clock jumped
  EXPECT_THROW(slam.forget("mug", std::nan("")), InvalidInput);
  // What comes next would be older than it by so much that the clock seemed to have jumped.
  EXPECT_NE(thrown_message([&] { slam.forget("mug", 31.0); }).find("after the newest input"),
            std::string::npos);
  EXPECT_TRUE(slam.estimate()->estimate.object("mug").world);
  const PoseDensity camera(SE3d(), isotropic(0.1, 0.001));
  ObjectSlam particles(camera, {{.id = "mug"}}, {.tracker = ParticleFilterSettings{}});
  EXPECT_EQ(thrown_message([&] { particles.forget(0); }),
            "this tracker forgets no object, expected the multi-object filter");
  ObjectSlam live(camera, {{.id = "mug"}});
  live.step({.detections = {kBefore}});
  live.forget(0);
  EXPECT_FALSE(live.pose_index(0));
}

TEST(Forget, AnObjectOnSightIsThereBeforeItsFirstSightingIsPlayed) {
  MultiObjectSlamSettings settings;
  settings.on_sight = ObjectModel{.id = ""};
  StampedSlam slam(PoseDensity(SE3d(), isotropic(0.1, 0.001)), {}, settings,
                   {.model = MotionModel::still});
  slam.add(seen_at("lid", kBefore, 1.0));
  EXPECT_EQ(slam.forget("lid"), StampAdmission::taken);
  EXPECT_FALSE(slam.estimate()->estimate.object("lid").world);
  EXPECT_THROW(slam.forget("led"), InvalidInput);
  slam.add(seen_at("lid", kAfter, 1.1));
  EXPECT_TRUE(slam.estimate()->estimate.object("lid").world);
}

}  // namespace
}  // namespace posemix
