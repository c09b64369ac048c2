// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "live_scene.hpp"

namespace posemix {
namespace {

using namespace testing;

const std::string kSeen = "[live]\nleast_existence = 0\n";
const std::string kStill = kSeen + "[motion]\nmodel = \"still\"\n";

/// All numbers of the objects of a message.
std::vector<double> covariance_of(const RosDetections& message) {
  std::vector<double> all;
  for (const RosDetection& object : message.detections) {
    for (const RosResult& of_object : object.results) {
      all.push_back(of_object.score);
      all.insert(all.end(), of_object.pose.begin(), of_object.pose.end());
      all.insert(all.end(), of_object.covariance.begin(), of_object.covariance.end());
    }
  }
  return all;
}

TEST(LiveNode, PublishesObjectsInTheWorld) {
  LiveBench bench(kSeen);
  for (int i = 0; i <= 10; ++i) {
    bench.move(0.1 * i);
    bench.see(0.1 * i);
  }
  ASSERT_EQ(bench.objects.size(), 11u);
  const RosDetections& last = bench.objects.back();
  EXPECT_EQ(last.header.stamp_ns, at_ns(1.0));
  EXPECT_EQ(last.header.frame, "map");
  ASSERT_EQ(last.detections.size(), 2u);
  const auto mug = std::ranges::find(last.detections, "mug", &RosDetection::id);
  ASSERT_NE(mug, last.detections.end());
  // The noise of a typical detector is wide, so that a turn of some degrees is no surprise.
  EXPECT_TRUE(pose_of(mug->results[0].pose).is_approx(mug_pose(), 0.1));
  EXPECT_EQ(mug->box, mug->results[0].pose);
  double sum = 0.0;
  for (const RosResult& of_mug : mug->results) sum += of_mug.score;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  // The odometry has drifted by nothing.
  const auto odom = std::ranges::find(bench.transforms, "odom", &RosTransform::child);
  ASSERT_NE(odom, bench.transforms.end());
  EXPECT_TRUE(pose_of(odom->pose).is_approx(SE3d(), 0.02));
}

TEST(LiveNode, ConfirmedObjectsAreInTf) {
  LiveBench bench("[live]\ntf_prefix = \"seen_\"\ntransform_time_offset_s = 0.5\n");
  for (int i = 0; i <= 20; ++i) {
    bench.move(0.5 * i);
    bench.see(0.5 * i);
  }
  const auto mug = std::ranges::find(bench.transforms, "seen_mug", &RosTransform::child);
  ASSERT_NE(mug, bench.transforms.end());
  EXPECT_EQ(mug->header.stamp_ns, at_ns(10.5));
  bench.node.diagnose();
  const auto status =
      std::ranges::find(bench.diagnostics.statuses, "posemix: mug", &RosStatus::name);
  ASSERT_NE(status, bench.diagnostics.statuses.end());
  EXPECT_EQ(status->message, "good");
  EXPECT_EQ(status->level, 0);
}

TEST(LiveNode, TheOrderOfDetectionsDoesNotMatter) {
  const auto last_of = [](const std::vector<double>& order) {
    LiveBench bench(kSeen);
    for (int i = 0; i <= 24; ++i) bench.move(0.05 * i);
    for (const double seconds : order) bench.see(seconds);
    return std::pair(covariance_of(bench.objects.back()), bench.counts().late);
  };
  const auto sorted = last_of({0.0, 0.2, 0.4, 0.6, 0.8, 1.0});
  const auto mixed = last_of({0.0, 0.4, 0.2, 0.8, 0.6, 1.0});
  EXPECT_FALSE(sorted.first.empty());
  EXPECT_EQ(sorted.first, mixed.first) << "to the last bit";
  EXPECT_EQ(sorted.second, 0u);
  EXPECT_EQ(mixed.second, 4u);
}

TEST(LiveNode, WhatIsOlderThanTheHistoryIsCountedAndLeftOut) {
  LiveBench bench(kStill);
  bench.see(0.0);
  bench.see(1.0);
  const auto before = covariance_of(bench.objects.back());
  bench.see(-0.5);
  EXPECT_EQ(bench.counts().too_late, 2u);
  EXPECT_EQ(covariance_of(bench.objects.back()), before);
}

TEST(LiveNode, AnImageWaitsForItsOdometryAndThenGoesWithout) {
  LiveBench bench(kSeen);
  bench.move(0.0);
  bench.see(0.0);
  bench.see(0.1);
  EXPECT_EQ(bench.counts().images, 1u);
  EXPECT_EQ(bench.status("waiting"), "1");
  bench.move(0.1);
  bench.node.work();
  EXPECT_EQ(bench.counts().images, 2u) << "the transform that comes while it waits is in time";
  bench.see(0.2);
  bench.now_s += 0.49;
  bench.node.work();
  EXPECT_EQ(bench.counts().images, 2u);
  bench.now_s += 0.02;
  bench.node.work();
  EXPECT_EQ(bench.counts().images, 3u);
  EXPECT_EQ(bench.counts().without_odometry, 1u);
  bench.node.diagnose();
  EXPECT_EQ(bench.diagnostics.statuses[0].message,
            "no odometry at 1700000000200000000 ns: /tf has no pose of \"camera\" in \"odom\" "
            "(motion.model says how the camera moves without)");
  EXPECT_EQ(bench.log.size(), 1u);
}

TEST(LiveNode, AnImageIsPublishedBeforeTheNextIsTakenIn) {
  LiveBench bench(kSeen);
  for (const double seconds : {0.0, 0.1, 0.2, 0.3}) bench.see(seconds);
  EXPECT_EQ(bench.status("waiting"), "4");
  for (const double seconds : {0.0, 0.1, 0.2, 0.3}) bench.move(seconds);
  for (std::size_t images = 1; images <= 4; ++images) {
    EXPECT_EQ(bench.node.work(), images < 4);
    EXPECT_EQ(bench.counts().images, images);
  }
  EXPECT_FALSE(bench.node.work());
}

TEST(LiveNode, DetectionsInAnotherFrameAreCarriedToTheCamera) {
  LiveBench bench(kSeen + "camera_frame = \"camera\"\n[motion]\nmodel = \"still\"\n");
  bench.detect(array_at(0.0, {{"mug", mug_pose()}}, "nowhere"));
  bench.now_s += 1.0;
  bench.node.work();
  EXPECT_EQ(bench.counts().dropped, 1u);
  EXPECT_NE(bench.log.back().find(R"(no transform from "nowhere" to "camera")"), std::string::npos);
  const SE3d by(SO3d(), {0.0, 0.0, 1.0});
  bench.node.take_transforms({{{0, "camera"}, "nowhere", numbers_of(by)}}, true);
  bench.detect(array_at(1.0, {{"mug", mug_pose()}}, "nowhere"));
  ASSERT_EQ(bench.objects.size(), 1u);
  EXPECT_TRUE(pose_of(bench.objects[0].detections[0].box).is_approx(by * mug_pose(), 1e-6));
}

TEST(LiveNode, OfMoreImagesThanMayWaitTheOldestAreDropped) {
  LiveBench bench("[live]\nqueue_size = 3\n");
  for (int i = 0; i < 10; ++i) bench.see(0.1 * i);
  EXPECT_EQ(bench.counts().dropped, 7u);
  EXPECT_EQ(bench.status("waiting"), "3");
}

TEST(LiveNode, OdometryMayBeATopicOfItsOwn) {
  LiveBench bench(kSeen + "odometry_topic = \"/odom\"\n");
  const SE3d arm(SO3d(), {0.0, 0.0, 0.3});
  bench.node.take_transforms({{{0, "base"}, "camera", numbers_of(arm)}}, true);
  for (int i = 0; i <= 8; ++i)
    bench.node.take_odometry(
        {{at_ns(0.1 * i), "odom"}, "base", numbers_of(camera_at(0.1 * i) * arm.inverse())});
  for (int i = 0; i <= 4; ++i) bench.see(0.2 * i);
  EXPECT_EQ(bench.counts().without_odometry, 0u);
  EXPECT_EQ(bench.counts().images, 5u);
  bench.node.take_odometry({{at_ns(1.0), "map"}, "base", numbers_of(SE3d())});
  EXPECT_NE(bench.log.back().find(R"(expected odom_frame, "odom")"), std::string::npos)
      << bench.log.back();
}

TEST(LiveNode, CamerasOfARigStandWhereTfStaticHasThem) {
  LiveBench bench(
      "[live]\nleast_existence = 0\ncameras = [\"left\", \"right\"]\n"
      "[motion]\nmodel = \"still\"\n");
  const std::map<std::string, SE3d> places{
      {"left", SE3d(SO3d(), {-0.1, 0.0, 0.0})},
      {"right", SE3d(SO3d::exp({0.0, 0.2, 0.0}), {0.1, 0.0, 0.0})}};
  for (const auto& [name, place] : places)
    bench.node.take_transforms({{{0, "base_link"}, name, numbers_of(place)}}, true);
  for (int i = 0; i < 6; ++i) {
    const std::string name = i % 2 == 0 ? "left" : "right";
    bench.detect(array_at(0.2 * i, {{"mug", places.at(name).inverse() * mug_pose()}}, name));
  }
  EXPECT_EQ(bench.counts().images, 6u);
  ASSERT_EQ(bench.objects.back().detections.size(), 1u);
  EXPECT_TRUE(pose_of(bench.objects.back().detections[0].box).is_approx(mug_pose(), 1e-3));
  bench.detect(array_at(1.2, {{"mug", mug_pose()}}, "third"));
  bench.now_s += 1.0;
  bench.node.work();
  EXPECT_EQ(bench.counts().dropped, 1u);
  EXPECT_NE(bench.log.back().find(R"("third")"), std::string::npos);
}

TEST(LiveNode, StampsThatJumpBackAreANewRecording) {
  LiveBench bench(kSeen);
  for (const double start : {100.0, 40.0}) {
    for (int i = 0; i < 6; ++i) {
      bench.move(start + 0.2 * i);
      bench.detect(array_at(start + 0.2 * i, {{start > 50.0 ? "mug" : "box", mug_pose()}}));
    }
  }
  EXPECT_EQ(bench.counts().resets, 1u);
  EXPECT_EQ(bench.counts().refused, 4u);
  EXPECT_EQ(bench.counts().images, 8u);
  ASSERT_EQ(bench.objects.back().detections.size(), 1u);
  EXPECT_EQ(bench.objects.back().detections[0].id, "box") << "the mug is forgotten";
}

TEST(LiveNode, OneWrongStampCostsOneImage) {
  LiveBench bench(kStill);
  bench.see(100.0);
  double stamp = 101.0;
  for (const double wrong : {5.0, 9000.0, 0.0, 50.0, 20.0, 8000.0}) {
    bench.see(wrong);
    bench.see(stamp);
    stamp += 1.0;
  }
  EXPECT_EQ(bench.counts().resets, 0u);
  EXPECT_EQ(bench.counts().refused, 6u);
  EXPECT_EQ(bench.counts().images, 7u);
}

TEST(LiveNode, UnlikeWrongStampsAreNoClock) {
  LiveBench bench(kStill);
  bench.see(100.0);
  for (const double wrong : {-5000.0, 9000.0, -300.0, 50000.0, -77.0, 50000.0}) bench.see(wrong);
  for (int i = 0; i < 6; ++i) bench.see(20.0);  // one moment, of several detectors
  EXPECT_EQ(bench.counts().resets, 0u);
  bench.see(101.0);
  EXPECT_EQ(bench.counts().images, 2u);
}

TEST(LiveNode, SingleStampsFarAheadAreRefusedAndManyAreAnotherClock) {
  LiveBench bench(kStill);
  bench.see(0.0);
  bench.see(9000.0);
  EXPECT_EQ(bench.counts().refused, 1u);
  bench.see(1.0);
  EXPECT_EQ(bench.counts().images, 2u);
  for (int i = 0; i < 6; ++i) bench.see(9000.0 + i);
  EXPECT_EQ(bench.counts().resets, 1u);
  EXPECT_EQ(bench.counts().refused, 5u);
  EXPECT_EQ(bench.counts().images, 4u);
}

TEST(LiveNode, ASimulatedClockThatStepsBackForgetsAll) {
  LiveBench bench(
      "[live]\nleast_existence = 0\nuse_sim_time = true\n[motion]\nmodel = \"still\"\n");
  bench.node.take_clock(at_ns(10.0));
  bench.see(10.0);
  bench.node.take_clock(at_ns(8.0));
  EXPECT_EQ(bench.counts().resets, 1u);
  bench.detect(array_at(8.0, {{"box", box_pose()}}));
  ASSERT_EQ(bench.objects.back().detections.size(), 1u);
  bench.node.diagnose();
  EXPECT_EQ(bench.diagnostics.header.stamp_ns, at_ns(8.0));
}

TEST(LiveNode, WhatIsWrongInAMessageIsSaidAndTheNodeLives) {
  LiveBench bench(kStill);
  RosDetections wrong = array_at(0.0, {{"mug", mug_pose()}});
  wrong.detections[0].results[0].pose[2] = std::numeric_limits<double>::quiet_NaN();
  bench.detect(wrong);
  wrong = array_at(0.1, {{"mug", mug_pose()}});
  wrong.detections[0].results[0].covariance.fill(-2.0);
  bench.detect(wrong);
  bench.node.take_transforms({{{0, "camera"}, "tool", {}}}, true);
  EXPECT_EQ(bench.counts().refused, 2u);
  EXPECT_EQ(bench.log.size(), 3u);
  bench.see(1.0);
  EXPECT_EQ(bench.counts().images, 1u);
  EXPECT_EQ(bench.objects.back().detections.size(), 2u);
}

TEST(LiveNode, OdometryThatIsAbsurdIsRefusedAndTheNodeGoesOn) {
  LiveBench bench(kSeen);
  for (int i = 0; i <= 5; ++i) {
    bench.move(0.1 * i);
    bench.see(0.1 * i);
  }
  const SE3d absurd(SO3d(), {1e160, 0.0, 0.0});
  bench.node.take_transforms({{{at_ns(0.6), "odom"}, "camera", numbers_of(absurd)}}, false);
  bench.see(0.6);
  const std::size_t before = bench.objects.size();
  for (int i = 7; i <= 12; ++i) {
    bench.move(0.1 * i);
    bench.see(0.1 * i);
  }
  EXPECT_GE(bench.objects.size(), before + 6);
  EXPECT_EQ(bench.objects.back().detections.size(), 2u);
}

TEST(LiveNode, WhatIsNotSeenAnyMoreIsLostAndNotInTf) {
  LiveBench bench("[motion]\nmodel = \"still\"\n");
  for (int i = 0; i < 20; ++i)
    bench.detect(array_at(0.5 * i, {{"mug", mug_pose()}, {"box", box_pose()}}));
  EXPECT_EQ(std::ranges::count(bench.transforms, "box", &RosTransform::child), 1);
  for (int i = 20; i < 44; ++i) bench.detect(array_at(0.5 * i, {}));
  bench.detect(array_at(22.0, {{"mug", mug_pose()}}));
  bench.node.diagnose();
  const auto status =
      std::ranges::find(bench.diagnostics.statuses, "posemix: box", &RosStatus::name);
  ASSERT_NE(status, bench.diagnostics.statuses.end());
  EXPECT_EQ(status->message, "lost");
  EXPECT_EQ(status->level, 2);
  EXPECT_EQ(std::ranges::count(bench.transforms, "box", &RosTransform::child), 0);
  EXPECT_EQ(std::ranges::count(bench.transforms, "mug", &RosTransform::child), 1);
}

TEST(LiveNode, AFrameThatHasAParentGetsNoSecondOne) {
  LiveBench bench(kSeen);
  bench.node.take_transforms({{{at_ns(0.0), "earth"}, "odom", numbers_of(SE3d())}}, false);
  bench.move(0.0);
  bench.see(0.0);
  EXPECT_EQ(std::ranges::count(bench.transforms, "odom", &RosTransform::child), 0);
  EXPECT_NE(bench.log.back().find("publish_world_tf"), std::string::npos);
}

TEST(LiveNode, InstancesOfAClassAreToldApart) {
  LiveBench bench(
      "[live]\nleast_existence = 0\n[motion]\nmodel = \"still\"\n"
      "[[objects]]\nid = \"nut_1\"\nclass = \"nut\"\n"
      "[[objects]]\nid = \"nut_2\"\nclass = \"nut\"\n");
  for (int i = 0; i < 5; ++i) {
    RosDetections message = array_at(0.2 * i, {{"nut", mug_pose()}, {"bolt", box_pose()}});
    message.detections.push_back(message.detections[1]);
    message.detections[2].results[0].pose = numbers_of(box_pose());
    bench.detect(message);
  }
  EXPECT_EQ(bench.objects.back().detections.size(), 2u);
  EXPECT_EQ(bench.objects.back().detections[0].results[0].class_id, "nut");
  EXPECT_EQ(bench.counts().ignored, 5u) << "bolts were not declared";
}

}  // namespace
}  // namespace posemix
