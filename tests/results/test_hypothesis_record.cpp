// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "posemix/base/random.hpp"
#include "results/trace_hypotheses.hpp"
#include "trace_folder.hpp"

/// Hypotheses out of memory, and fewer of them in a page.
namespace posemix {
namespace {

using nlohmann::json;
using testing::ReportTrace;
using testing::SmallResults;
using testing::TraceFolder;

TEST(HypothesisRecord, GivesTheSameFiles) {
  for (const std::vector<std::string>& overrides : {std::vector<std::string>{},
                                                    {"filter={}"},
                                                    {"filter={smooth=\"full\"}"},
                                                    {"filter={smooth=\"fixed_lag\", smooth_lag=3}"},
                                                    {"output.trace_hypotheses=0"},
                                                    {"filter={}", "output.trace_hypotheses=1"}}) {
    const SmallResults results(overrides);
    const SlamJob& job = *results.job;
    const bool records = job.trace_hypotheses > 0;
    const testing::TemporaryFolder folder;
    HypothesisRecord record(job, folder.path());
    std::size_t calls = 0;
    const SlamRun slam =
        run(job, {.record_hypotheses = records, .estimated = [&](FrameEstimate& frame) {
                    ++calls;
                    record.take(frame);
                  }});
    EXPECT_EQ(calls, testing::kSmallFrames);
    for (const FrameEstimate& frame : slam.frames)
      EXPECT_TRUE(frame.hypotheses.empty() && frame.alternatives.empty());
    const SlamRun kept = run(job, {.record_hypotheses = records});
    for (const auto& [name, text] :
         format_results(job, slam, results.metrics, {.hypotheses = &record})) {
      if (name != "trace.json") continue;
      EXPECT_EQ(text, format_trace(job, kept)) << overrides.size();
    }
  }
}

TEST(HypothesisRecord, MustHaveTheFramesOfTheRun) {
  const SmallResults results;
  const testing::TemporaryFolder folder;
  const HypothesisRecord record(*results.job, folder.path());
  EXPECT_INVALID_WITH(
      format_results(*results.job, *results.slam, results.metrics, {.hypotheses = &record}),
      "recorded hypotheses of 0 frames, expected 20");
}

/// Hypotheses at places that differ at random, so that they cannot be compressed, the lightest
/// first.
void fill(internal::HypothesisStore& store, std::size_t frames, std::size_t hypotheses) {
  RandomStream random(3);
  const std::size_t mug = store.add_entity("objects/mug");
  const std::size_t late = store.add_entity("objects/late", frames / 2);
  for (std::size_t k = 0; k < frames; ++k) {
    std::vector<internal::TraceHypothesis> list;
    for (std::size_t h = hypotheses; h-- > 0;) {
      const json pose = {random.uniform(), random.uniform(), random.uniform(), 0, 0, 0, 1};
      const internal::Json entry = pose;
      list.push_back(store.hypothesis(static_cast<std::int32_t>(h),
                                      1.0 / static_cast<double>(h + 2),
                                      internal::TracePlace(entry, "pose", k)));
    }
    store.add(mug, list);
    if (k >= frames / 2) store.add(late, {list.back()});
  }
}

/// The columns of a store within a number of bytes.
ReportTrace written(internal::HypothesisStore& store, std::size_t frames, std::size_t most_bytes) {
  internal::Deflater data;
  internal::Json headers = internal::Json::array();
  store.write(most_bytes, data, headers);
  const std::string stream = data.finish();
  EXPECT_LT(stream.size(), most_bytes + most_bytes / 50);
  return ReportTrace({{"frames", frames},
                      {"columns", json::parse(headers.dump())},
                      {"data", internal::base64(stream)}});
}

std::set<int> ids_at(const ReportTrace& trace, const std::string& entity, std::size_t frame) {
  std::set<int> ids;
  for (std::size_t slot = 0;; ++slot) {
    const std::string at = entity + "/hypotheses/" + std::to_string(slot);
    if (!trace.has(at + "/mask")) return ids;
    if (trace.masked(at + "/mask", frame, 0))
      ids.insert(static_cast<int>(trace[at + "/id"][frame][0]));
  }
}

TEST(HypothesisStore, KeepsTheHeaviestOfEveryFrame) {
  constexpr std::size_t kFrames = 500;
  internal::HypothesisStore store{internal::TraceScales()};
  fill(store, kFrames, 20);
  const ReportTrace trace = written(store, kFrames, 40000);
  ASSERT_TRUE(store.kept().has_value());
  const auto kept = static_cast<int>(*store.kept());
  EXPECT_GE(kept, 4);
  EXPECT_LT(kept, 12);
  std::set<int> heaviest;
  for (int id = 0; id < kept; ++id) heaviest.insert(id);
  for (const std::size_t k : {std::size_t{0}, kFrames / 2, kFrames - 1})
    EXPECT_EQ(ids_at(trace, "objects/mug", k), heaviest) << k;
  EXPECT_EQ(ids_at(trace, "objects/late", kFrames / 2 - 1), std::set<int>{});
  EXPECT_EQ(ids_at(trace, "objects/late", kFrames / 2), std::set<int>{0});
}

TEST(HypothesisStore, KeepsOneWhateverTheLimit) {
  internal::HypothesisStore store{internal::TraceScales()};
  fill(store, 100, 5);
  internal::Deflater data;
  internal::Json headers = internal::Json::array();
  store.write(10, data, headers);
  EXPECT_EQ(store.kept(), 1U);
}

TEST(HypothesisStore, KeepsAllThatHaveRoom) {
  internal::HypothesisStore store{internal::TraceScales()};
  fill(store, 100, 20);
  const ReportTrace trace = written(store, 100, 1000000);
  EXPECT_FALSE(store.kept().has_value());
  EXPECT_EQ(ids_at(trace, "objects/mug", 99).size(), 20U);
}

TEST(HypothesisStore, LimitsItsMemory) {
  internal::HypothesisStore store{internal::TraceScales()};
  const std::size_t mug = store.add_entity("objects/mug");
  const std::vector<internal::TraceHypothesis> list(1000);
  for (std::size_t k = 0; k < 4000; ++k) store.add(mug, list);
  ASSERT_TRUE(store.kept().has_value());
  EXPECT_LT(4000 * *store.kept(), 1500000U);
  EXPECT_GT(4000 * *store.kept(), 400000U);
}

}  // namespace
}  // namespace posemix
