// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/trace_tracks.hpp"

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "posemix/results/report.hpp"
#include "small_results.hpp"

namespace posemix {
namespace {

using nlohmann::json;
using testing::results;
using Results = testing::SmallResults;

TEST(TraceTracks, AreEstimatesWithTheirTruth) {
  const std::filesystem::path path = results().small.folder / "trace.json";
  results().small.folder.put("trace.json", results().files.at("trace.json"));
  const std::vector<TraceTrack> tracks = read_trace_tracks(path);
  ASSERT_EQ(tracks.size(), 1 + 2 * results().job->models.size());
  EXPECT_EQ(tracks[0].name, "camera");
  EXPECT_EQ(tracks[1].name, "objects/mug/world");
  EXPECT_EQ(tracks[2].name, "objects/mug/relative");
  const FrameEstimate& last = results().slam->frames.back();
  const PoseDensity& camera = tracks[0].estimates.back().estimate;
  EXPECT_TRUE(camera.mean().is_approx(last.camera.mean(), 1e-8));
  EXPECT_LT((camera.covariance() - last.camera.covariance()).cwiseAbs().maxCoeff(),
            1e-8 * last.camera.covariance().cwiseAbs().maxCoeff());
  const auto pairs = match_to_truth(tracks[2].estimates, tracks[2].truth);
  EXPECT_NEAR(consistency_of(pairs).pose.anees, *results().metrics.objects[0].relative_anees,
              1e-4 * *results().metrics.objects[0].relative_anees);
  EXPECT_TRUE(tracks[2].symmetries.is_trivial());
}

TEST(TraceTracks, AnObjectMayHaveAnyName) {
  json trace = json::parse(results().files.at("trace.json"));
  for (const char* name : {"covariance", "detection"}) {
    json renamed = trace;
    renamed["objects"][name] = renamed["objects"]["mug"];
    renamed["objects"].erase("mug");
    for (json& id : renamed["order"]) id = id == "mug" ? json(name) : id;
    const auto& folder = results().small.folder;
    folder.put("names/trace.json", renamed.dump());
    folder.put("names/metrics.json", results().files.at("metrics.json"));
    EXPECT_EQ(read_trace_tracks(folder / "names/trace.json").size(), 7U);
    EXPECT_NE(format_report(folder / "names").find(name), std::string::npos);
  }
}

TEST(TraceTracks, ATraceOfAnOlderVersionHasNone) {
  json trace = json::parse(results().files.at("trace.json"));
  trace["camera"].erase("covariance");
  results().small.folder.put("old.json", trace.dump());
  EXPECT_INVALID_WITH(read_trace_tracks(results().small.folder / "old.json"),
                      "old.json: camera: got no covariances");
  results().small.folder.put("no.json", "{");
  EXPECT_INVALID_WITH(read_trace_tracks(results().small.folder / "no.json"), "not JSON");
}

TEST(TraceTracks, HaveTheDeclaredSymmetries) {
  const Results all({"objects.can.symmetries={axes=[{direction=[0, 0, 1], point_m=[0.1, 0, 0]}]}"});
  const json trace = json::parse(all.files.at("trace.json"));
  const json& can = trace["objects"]["can"]["symmetries"];
  EXPECT_EQ(can["elements"].size(), 1U);
  EXPECT_EQ(can["axes"][0]["direction"], json({0.0, 0.0, 1.0}));
  EXPECT_EQ(can["axes"][0]["point_m"], json({0.1, 0.0, 0.0}));
  EXPECT_FALSE(trace["objects"]["mug"].contains("symmetries"));
  results().small.folder.put("can.json", all.files.at("trace.json"));
  const std::vector<TraceTrack> tracks = read_trace_tracks(results().small.folder / "can.json");
  const TraceTrack& relative = tracks.back();
  EXPECT_EQ(relative.symmetries.axes().size(), 1U);
  // The truth is the nearest of the equivalent poses.
  const ErrorReduction reduction(relative.symmetries);
  const SE3d& estimate = relative.estimates.back().estimate.mean();
  const SE3d& truth = relative.truth.back().pose;
  EXPECT_TRUE(reduction.nearest(truth, estimate).is_approx(truth, 1e-4));
}

}  // namespace
}  // namespace posemix
