// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "live_scene.hpp"
#include "posemix/results/results.hpp"

namespace posemix {
namespace {

using namespace testing;

/// Eleven images of mug and box, two of them out of order, and one of nothing.
void play(LiveBench& bench) {
  for (int i = 0; i <= 24; ++i) bench.move(0.05 * i);
  for (const double seconds : {0.0, 0.2, 0.1, 0.3, 0.5, 0.4, 0.6}) bench.see(seconds);
  bench.detect({.header = {at_ns(0.65), "camera"}});
  for (const double seconds : {0.7, 0.8, 0.9, 1.0}) bench.see(seconds);
}

TEST(LiveResults, ARunOverWhatWasTakenInEndsWhereTheLiveOneDid) {
  LiveBench bench("", true);
  play(bench);
  const auto result = bench.node.engine().result();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->start_s, 1.7e9);
  ASSERT_EQ(result->job.sequence.stamps.size(), 12u);
  const SlamRun run = posemix::run(result->job);
  const FrameEstimate& last = run.frames.back();
  ASSERT_EQ(bench.objects.back().detections.size(), 2u);
  for (const RosDetection& object : bench.objects.back().detections) {
    const auto& world = last.objects[last.index_of(object.id)];
    ASSERT_TRUE(world);
    EXPECT_EQ(numbers_of(world->mean()), object.box) << "to the last bit";
  }
}

TEST(LiveResults, AllFilesAreWrittenWhateverTheNamesOfClasses) {
  LiveBench bench("[motion]\nmodel = \"still\"\n", true);
  for (int i = 0; i < 5; ++i)
    bench.detect(array_at(0.1 * i, {{"ycb/mug 1", mug_pose()}, {"ycb:mug 1", box_pose()}}));
  auto result = bench.node.engine().result();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->job.models[0].id, "ycb_mug_1");
  EXPECT_EQ(result->job.models[1].id, "ycb_mug_1_2");
  const SlamRun run = posemix::run(result->job, {true, {}});
  const auto files = format_results(result->job, run, evaluate(result->job, run));
  const auto has = [&](const std::string& name) {
    return std::ranges::any_of(files, [&](const auto& file) { return file.first == name; });
  };
  for (const char* name : {"trace.json", "object_ycb_mug_1.tum", "object_ycb_mug_1_2.tum"})
    EXPECT_TRUE(has(name)) << name;
}

TEST(LiveResults, OnlyTheLastImagesAreKept) {
  LiveBench bench("[motion]\nmodel = \"still\"\n[output]\nimages = 3\n", true);
  for (int i = 0; i < 10; ++i) bench.see(0.1 * i);
  const auto result = bench.node.engine().result();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->job.sequence.stamps.size(), 3u);
  EXPECT_NEAR(result->start_s, 1.7e9 + 0.7, 1e-6);
}

TEST(LiveResults, WithoutRecordingOrImagesThereIsNone) {
  LiveBench without("");
  play(without);
  EXPECT_FALSE(without.node.engine().result());
  LiveBench empty("", true);
  EXPECT_FALSE(empty.node.engine().result());
}

}  // namespace
}  // namespace posemix
