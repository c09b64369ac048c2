// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "live_scene.hpp"

/// In which world the objects of a live run are, and what stays of it.
namespace posemix {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace)

const std::string kAll = "[live]\nleast_existence = 0\n";

/// What a still camera sees while its odometry is not known, and later.
SE3d late_mug(const std::string& text, double moved_m) {
  LiveBench bench(text);
  const SE3d camera(SO3d::exp({-1.2, 0.3, 0.8}), {moved_m, 0.2, 0.5});
  for (int i = 0; i < 3; ++i) {
    bench.detect(array_at(0.2 * i, {{"mug", mug_pose()}}));
    bench.now_s += 1.0;  // the time for waiting is over
    while (bench.node.work()) continue;
  }
  for (int i = 3; i < 6; ++i) {
    bench.node.take_transforms({{{at_ns(0.2 * i), "odom"}, "camera", numbers_of(camera)}}, false);
    bench.detect(array_at(0.2 * i, {{"mug", mug_pose()}}));
  }
  // Under the model `given` nothing is said before; else that world is forgotten, with a word.
  const bool is_given = text.find("given") != std::string::npos;
  EXPECT_EQ(bench.counts().dropped, is_given ? 3u : 0u);
  EXPECT_EQ(bench.counts().without_odometry, 3u);
  EXPECT_EQ(bench.counts().resets, is_given ? 0u : 1u);
  EXPECT_EQ(std::ranges::any_of(bench.log,
                                [](const std::string& line) {
                                  return line.find("odometry has come") != std::string::npos;
                                }),
            !is_given);
  return camera.inverse() * pose_of(bench.objects.back().detections.at(0).box);
}

// A run that begins before the odometry is heard had the camera's first view for its world.
TEST(LiveWorld, IsThatOfAnOdometryThatComesLate) {
  EXPECT_TRUE(late_mug(kAll, 3.0).is_approx(mug_pose(), 2e-3));
  EXPECT_TRUE(late_mug(kAll + "[motion]\nmodel = \"given\"\n", 3.0).is_approx(mug_pose(), 2e-3));
}

TEST(LiveWorld, IsPutAboveTheOdometryByNobodyElse) {
  LiveBench bench(kAll);
  bench.node.take_transforms({{{at_ns(0.0), "map"}, "odom", numbers_of(SE3d())}}, false);
  bench.move(0.0);
  bench.see(0.0);
  EXPECT_EQ(std::ranges::count(bench.transforms, "odom", &RosTransform::child), 0);
  EXPECT_NE(bench.log.back().find("publish_world_tf"), std::string::npos);
}

TEST(LiveWorld, FramesMayBeginWithASlash) {
  const LiveSettings settings = live_settings(
      "[live]\nworld_frame = \"/map\"\nodom_frame = \"/odom\"\nbody_frame = \"/base\"\n"
      "cameras = [\"/left\"]\n");
  EXPECT_EQ(settings.node.world_frame, "map");
  EXPECT_EQ(settings.node.odom_frame, "odom");
  EXPECT_EQ(settings.node.body_frame, "base");
  EXPECT_EQ(settings.node.cameras, std::vector<std::string>{"left"});
}

// An array without detections was searched by its own detector, which finds other things.
TEST(LiveWorld, LosesNothingThatAnotherDetectorDoesNotFind) {
  LiveBench bench(
      "[motion]\nmodel = \"still\"\n[[sources]]\nname = \"mugs\"\n[[sources]]\nname = "
      "\"boxes\"\n");
  for (int i = 0; i < 300; ++i) {
    if (i % 10 == 0) bench.detect(array_at(0.1 * i, {{"mug", mug_pose()}}), 0);
    bench.detect(array_at(0.1 * i + 0.05, {}), 1);
  }
  bench.node.diagnose();
  EXPECT_EQ(bench.diagnostics.statuses.back().name, "posemix: mug");
  EXPECT_EQ(bench.diagnostics.statuses.back().message, "good");
  // Where the one that has found it finds nothing any more, it is gone.
  for (int i = 300; i < 600; ++i) bench.detect(array_at(0.1 * i, {}), 0);
  bench.node.diagnose();
  EXPECT_EQ(bench.diagnostics.statuses.back().message, "lost");
}

TEST(LiveWorld, IsEmptyAfterAReset) {
  LiveBench bench(kAll + "[motion]\nmodel = \"still\"\n");
  bench.see(0.0);
  EXPECT_EQ(bench.objects.back().detections.size(), 2u);
  bench.node.reset();
  EXPECT_TRUE(bench.objects.back().detections.empty());
  EXPECT_EQ(bench.objects.back().header.frame, "map");
}

// What is forgotten because the clock has jumped is published no more, also where nothing follows.
TEST(LiveWorld, IsEmptyWhereNothingFollowsAJump) {
  LiveBench bench(kAll + "[motion]\nmodel = \"given\"\n");
  bench.move(0.0);
  bench.see(0.0);
  EXPECT_EQ(bench.objects.back().detections.size(), 2u);
  for (int i = 0; i < 6; ++i) {
    bench.detect(array_at(5000.0 + i, {{"mug", mug_pose()}}));
    bench.now_s += 1.0;
    while (bench.node.work()) continue;
  }
  EXPECT_EQ(bench.counts().resets, 1u);
  EXPECT_TRUE(bench.objects.back().detections.empty());
}

TEST(LiveWorld, EmptyImagesOlderThanTheHistoryAreComplainedOfOnce) {
  LiveBench bench(kAll + "[motion]\nmodel = \"still\"\n");
  bench.see(0.0);
  bench.see(5.0);
  const std::size_t before = bench.log.size();
  for (int i = 0; i < 10; ++i) bench.detect(array_at(3.0 + 0.1 * i, {}));
  EXPECT_EQ(bench.counts().too_late, 10u);
  EXPECT_EQ(bench.log.size(), before + 1);
}

TEST(LiveWorld, ImagesOlderThanTheHistoryAreComplainedOf) {
  LiveBench bench(kAll + "[motion]\nmodel = \"still\"\n");
  bench.see(0.0);
  bench.see(5.0);
  bench.see(3.0);
  EXPECT_EQ(bench.counts().too_late, 2u);
  EXPECT_NE(bench.log.back().find("2.0 s older than the newest one"), std::string::npos)
      << bench.log.back();
}

// Readers of /tf take one transform of a time, and warn of others.
TEST(LiveWorld, HasOneTransformOfATime) {
  LiveBench bench(kAll + "[motion]\nmodel = \"still\"\n");
  for (int i = 0; i < 20; ++i) bench.see(0.5 * i);
  EXPECT_FALSE(bench.transforms.empty());
  bench.transforms.clear();
  bench.see(9.5);
  EXPECT_TRUE(bench.transforms.empty());
  bench.see(10.0);
  EXPECT_FALSE(bench.transforms.empty());
}

/// The frames of the transforms since the last call.
std::vector<std::string> taken_frames(LiveBench& bench) {
  std::vector<std::string> frames;
  for (const RosTransform& transform : bench.transforms) frames.push_back(transform.child);
  bench.transforms.clear();
  return frames;
}

TEST(LiveWorld, AFrameIsInTfOnceOfATimeAlsoWhereASecondImageOfItKnowsMore) {
  LiveBench bench(kAll);
  bench.move(0.0);
  bench.see(0.0);
  EXPECT_EQ(taken_frames(bench), std::vector<std::string>{"odom"});
  // The odometry comes after the time for waiting, and then the image of another detector.
  bench.see(0.2);
  bench.now_s += 0.51;
  bench.node.work();
  EXPECT_EQ(bench.counts().without_odometry, 1u);
  EXPECT_EQ(taken_frames(bench), std::vector<std::string>{});
  bench.move(0.2);
  bench.see(0.2);
  EXPECT_EQ(taken_frames(bench), std::vector<std::string>{"odom"});
  bench.see(0.2);
  EXPECT_EQ(taken_frames(bench), std::vector<std::string>{});
  EXPECT_EQ(bench.counts().images, 4u);
}

}  // namespace
}  // namespace posemix
