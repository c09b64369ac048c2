// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/results.hpp"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "posemix/io/mixture_file.hpp"
#include "small_results.hpp"

namespace posemix {
namespace {

using nlohmann::json;
using testing::kSmallFrames;

using testing::results;
using Results = testing::SmallResults;

TEST(Results, NamesOfFiles) {
  std::vector<std::string> names;
  for (const auto& [name, text] : results().files) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{
                       "camera.tum", "metrics.json", "object_box.tum", "object_can.tum",
                       "object_mug.tum", "picture.svg", "posterior.json", "relative_box.tum",
                       "relative_can.tum", "relative_mug.tum", "trace.json"}));
}

TEST(Results, HaveTheCamerasOfARigWhereOneIsCalibrated) {
  SlamRun slam = *results().slam;
  const Matrix6d known = 1e-4 * Matrix6d::Identity();
  slam.cameras = {{"left", SE3d()}, {"right", SE3d(SO3d(), {0.5, 0, 0}), known}};
  const auto files = format_results(*results().job, slam, results().metrics);
  const auto found = std::find_if(files.begin(), files.end(),
                                  [](const auto& file) { return file.first == "cameras.csv"; });
  ASSERT_NE(found, files.end());
  const std::string& text = found->second;
  EXPECT_EQ(text.substr(0, 12), "camera,tx_m,");
  EXPECT_NE(text.find("\nleft,0,0,0,0,0,0,1,,"), std::string::npos) << text;
  EXPECT_NE(text.find("\nright,0.5,0,0,0,0,0,1,0.0001,0,"), std::string::npos) << text;
  slam.cameras.pop_back();
  for (const auto& [name, content] : format_results(*results().job, slam, results().metrics))
    EXPECT_NE(name, "cameras.csv");
}

TEST(Results, TrajectoriesAreTheEstimates) {
  const auto camera = parse_tum(results().files.at("camera.tum"), "camera.tum");
  const auto world = parse_tum(results().files.at("object_box.tum"), "object_box.tum");
  const auto relative = parse_tum(results().files.at("relative_box.tum"), "relative_box.tum");
  ASSERT_EQ(camera.size(), kSmallFrames);
  ASSERT_EQ(relative.size(), kSmallFrames);
  for (std::size_t k = 0; k < kSmallFrames; ++k) {
    EXPECT_EQ(camera[k].stamp, results().job->sequence.stamps[k]);
    EXPECT_TRUE(camera[k].pose->is_approx(results().slam->frames[k].camera.mean(), 1e-11));
    EXPECT_TRUE(relative[k].pose->is_approx(camera[k].pose->inverse() * *world[k].pose, 1e-10));
  }
}

TEST(Results, ObjectsNotSeenYetAreLeftOut) {
  testing::SmallFolder small;
  small.folder.put("late.txt", "1.5 0 0 0.5 0 0 0 1\n");
  Results late({"objects.mug.detections.tum=" + (small.folder / "late.txt").string()});
  const auto mug = parse_tum(late.files.at("relative_mug.tum"), "relative_mug.tum");
  ASSERT_EQ(mug.size(), 5U);
  EXPECT_EQ(mug.front().stamp, 1.5);
  const json trace = json::parse(late.files.at("trace.json"));
  EXPECT_TRUE(trace["objects"]["mug"]["world"]["pose"][14].is_null());
  EXPECT_EQ(trace["objects"]["mug"]["status"][15], "started");
  EXPECT_TRUE(trace["hypotheses"][14][0]["poses"][1].is_null());
}

TEST(Results, MetricsFollowTheSchema) {
  const json metrics = json::parse(results().files.at("metrics.json"));
  EXPECT_EQ(metrics["schema"], 1);
  EXPECT_EQ(metrics["frames"], kSmallFrames);
  EXPECT_EQ(metrics["method"], "gm-iekf (midway)");
  const auto keys = [](const json& object) {
    std::vector<std::string> names;
    for (const auto& [key, value] : object.items()) names.push_back(key);
    return names;
  };
  EXPECT_EQ(keys(metrics), (std::vector<std::string>{"camera", "camera_consistency", "consistency",
                                                     "files", "frames", "method", "objects",
                                                     "odometry", "relative_consistency", "run",
                                                     "schema", "timing", "world_consistency"}));
  EXPECT_EQ(
      keys(metrics["camera"]),
      (std::vector<std::string>{"position_log_rmse_m", "position_rmse_m", "rotation_rmse_deg"}));
  EXPECT_EQ(keys(metrics["objects"]["mug"]),
            (std::vector<std::string>{"detection_relative_position_rmse_m",
                                      "detection_relative_rotation_rmse_deg", "detections", "gated",
                                      "mode_probability", "paired", "position_rmse_m",
                                      "relative_position_rmse_m", "relative_rotation_rmse_deg",
                                      "right_mode_share", "rotation_rmse_deg", "unexplained"}));
  const PairedErrors& paired = results().metrics.objects[0].paired;
  EXPECT_EQ(metrics["objects"]["mug"]["paired"],
            json({{"frames", paired.frames},
                  {"estimate",
                   {{"position_median_m", *paired.estimate.position_m},
                    {"rotation_median_deg", *paired.estimate.rotation_deg}}},
                  {"detection",
                   {{"position_median_m", *paired.detection.position_m},
                    {"rotation_median_deg", *paired.detection.rotation_deg}}}}));
  EXPECT_EQ(keys(metrics["timing"]),
            (std::vector<std::string>{"frame_median_us", "merges_per_frame", "reduce_median_us",
                                      "update_median_us"}));
  EXPECT_EQ(metrics["objects"]["mug"]["detections"], kSmallFrames - 1);
  EXPECT_EQ(metrics["objects"]["can"]["relative_rotation_rmse_deg"].get<double>(),
            *results().metrics.objects[2].relative.rotation_rmse_deg);
  EXPECT_EQ(metrics["consistency"]["relative_anees"]["box"].get<double>(),
            *results().metrics.objects[1].relative_anees);
}

TEST(Results, MetricsHaveTheConsistencyOfEveryPose) {
  const json metrics = json::parse(results().files.at("metrics.json"));
  const std::vector<std::string> names{"anees", "median_nees", "position_anees", "rotation_anees"};
  const json& camera = metrics["camera_consistency"];
  for (const std::string& name : names) {
    EXPECT_GT(camera[name].get<double>(), 0.0) << name;
    for (const char* pose : {"world_consistency", "relative_consistency"})
      EXPECT_GT(metrics[pose]["box"][name].get<double>(), 0.0) << pose << name;
  }
  EXPECT_EQ(camera["anees"].get<double>(), *results().metrics.camera_consistency.anees);
  EXPECT_NEAR(metrics["relative_consistency"]["box"]["anees"].get<double>(),
              metrics["consistency"]["relative_anees"]["box"].get<double>(), 1e-9);
}

TEST(Results, TheMultiObjectFilterWritesItsHypotheses) {
  const Results all({"filter={}"});
  ASSERT_TRUE(all.files.contains("mixture_mug.json"));
  const MixtureFile file = parse_mixture(all.files.at("mixture_mug.json"), "mixture_mug.json");
  EXPECT_EQ(file.frames, (FrameNames{"world", "mug"}));
  const auto& mixture = std::get<Mixture<ConcentratedGaussian<SE3d>>>(file.mixture);
  EXPECT_GE(mixture.size(), 1U);
  const json trace = json::parse(all.files.at("trace.json"));
  const json& mug = trace["objects"]["mug"];
  ASSERT_EQ(mug["mode_probability"].size(), kSmallFrames);
  ASSERT_EQ(mug["alternatives"].size(), kSmallFrames);
  const json metrics = json::parse(all.files.at("metrics.json"));
  EXPECT_EQ(metrics["method"], "multi-object");
  const double probability = metrics["objects"]["mug"]["mode_probability"];
  EXPECT_GT(probability, 0.0);
  EXPECT_LE(probability, 1.0);
  EXPECT_NEAR(mug["mode_probability"].back().get<double>(), probability, 1e-9);
  EXPECT_NEAR(mug["alternatives"].back()[0]["probability"].get<double>(), probability, 1e-6);
}

TEST(Results, TheMultiObjectFilterWritesExistenceAndHealth) {
  const Results all({"filter={}"});
  const json trace = json::parse(all.files.at("trace.json"));
  const json& mug = trace["objects"]["mug"];
  const json metrics = json::parse(all.files.at("metrics.json"))["objects"]["mug"];
  std::map<std::string, double> frames;
  for (std::size_t k = 0; k < kSmallFrames; ++k) {
    const ObjectEstimate estimate = all.slam->frames[k].object("mug");
    EXPECT_EQ(mug["existence"][k].is_null(), !estimate.existence) << k;
    if (estimate.existence) {
      EXPECT_NEAR(mug["existence"][k].get<double>(), *estimate.existence, 1e-6);
    }
    EXPECT_EQ(mug["health"][k], word_of(estimate.health)) << k;
    EXPECT_EQ(mug["register_again"][k], estimate.register_again) << k;
    frames[mug["health"][k]] += 1.0;
  }
  EXPECT_EQ(metrics["existence"], *all.slam->frames.back().object("mug").existence);
  EXPECT_EQ(metrics["health"], mug["health"].back());
  ASSERT_EQ(metrics["health_shares"].size(), words<TrackHealth>.size());
  for (const auto& [word, share] : metrics["health_shares"].items())
    EXPECT_NEAR(share.get<double>(), frames[word] / kSmallFrames, 1e-12) << word;
  // Other trackers have neither.
  EXPECT_FALSE(json::parse(results().files.at("trace.json"))["objects"]["mug"].contains("health"));
  EXPECT_FALSE(
      json::parse(results().files.at("metrics.json"))["objects"]["mug"].contains("existence"));
}

TEST(Results, NullWithoutGroundTruth) {
  Metrics metrics;
  metrics.objects.emplace_back().id = "mug";
  metrics.camera.position_rmse_m = std::nan("");
  const json parsed = json::parse(format_metrics(metrics, "riekf"));
  EXPECT_TRUE(parsed["camera"]["position_rmse_m"].is_null());
  EXPECT_TRUE(parsed["camera"]["rotation_rmse_deg"].is_null());
  EXPECT_TRUE(parsed["objects"]["mug"]["position_rmse_m"].is_null());
  EXPECT_EQ(parsed["objects"]["mug"]["paired"]["frames"], 0);
  EXPECT_TRUE(parsed["objects"]["mug"]["paired"]["estimate"]["rotation_median_deg"].is_null());
  EXPECT_TRUE(parsed["consistency"]["relative_anees"]["mug"].is_null());
}

TEST(Results, TraceHoldsTheRun) {
  const json trace = json::parse(results().files.at("trace.json"));
  EXPECT_EQ(trace["schema"], 1);
  EXPECT_EQ(trace["type"], "posemix.trace");
  EXPECT_EQ(trace["stamps_s"].get<std::vector<double>>(), results().job->sequence.stamps);
  EXPECT_EQ(trace["order"], json({"mug", "box", "can"}));
  EXPECT_EQ(trace["camera"]["pose"].size(), kSmallFrames);
  EXPECT_EQ(trace["camera"]["truth"].size(), kSmallFrames);
  const FrameEstimate& frame = results().slam->frames[7];
  const auto pose = trace["camera"]["pose"][7].get<std::vector<double>>();
  const auto sd = trace["objects"]["box"]["relative"]["sd"][7].get<std::vector<double>>();
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(pose[static_cast<std::size_t>(i)], frame.camera.mean().translation()[i], 1e-8);
    EXPECT_NEAR(sd[static_cast<std::size_t>(i)], std::sqrt(frame.relative[1]->covariance()(i, i)),
                1e-8);
  }
  EXPECT_TRUE(trace["objects"]["mug"]["detection"][3].is_null());
  EXPECT_EQ(trace["objects"]["mug"]["status"][3], "none");
  double total = 0.0;
  double last = 1.0;
  for (const json& hypothesis : trace["hypotheses"][9]) {
    EXPECT_LE(hypothesis["weight"], last);
    last = hypothesis["weight"];
    total += last;
    EXPECT_EQ(hypothesis["poses"].size(), 4U);
  }
  EXPECT_NEAR(total, 1.0, 1e-6);
}

TEST(Results, TraceHoldsTheCovarianceOfPositions) {
  const json trace = json::parse(results().files.at("trace.json"));
  const json& track = trace["objects"]["box"]["relative"];
  ASSERT_EQ(track["position_covariance"].size(), kSmallFrames);
  const PoseDensity& density = *results().slam->frames[7].relative[1];
  // Differences of the position in the directions of xi.
  const double step = 1e-6;
  Eigen::Matrix<double, 3, 6> jacobian;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Vector6d xi = step * Vector6d::Unit(i);
    const SE3d plus = SE3d::exp(xi) * density.mean();
    const SE3d minus = SE3d::exp(-xi) * density.mean();
    jacobian.col(i) = (plus.translation() - minus.translation()) / (2.0 * step);
  }
  const Eigen::Matrix3d expected = jacobian * density.covariance() * jacobian.transpose();
  const auto upper = track["position_covariance"][7].get<std::vector<double>>();
  const double tolerance = 1e-6 * expected.norm();
  EXPECT_NEAR(upper[0], expected(0, 0), tolerance);
  EXPECT_NEAR(upper[1], expected(0, 1), tolerance);
  EXPECT_NEAR(upper[2], expected(0, 2), tolerance);
  EXPECT_NEAR(upper[3], expected(1, 1), tolerance);
  EXPECT_NEAR(upper[4], expected(1, 2), tolerance);
  EXPECT_NEAR(upper[5], expected(2, 2), tolerance);
}

TEST(Results, TraceKeepsTheHeaviestHypotheses) {
  const Results one({"output.trace_hypotheses=1"});
  const json trace = json::parse(one.files.at("trace.json"));
  EXPECT_EQ(trace["hypotheses"][9].size(), 1U);
  const Results none({"output.trace_hypotheses=0"});
  EXPECT_EQ(json::parse(none.files.at("trace.json"))["hypotheses"][9].size(), 0U);
}

TEST(Results, EstimatesThatAreNotFiniteAreAnError) {
  SlamRun damaged = *results().slam;
  damaged.frames[4].camera =
      PoseDensity::trusted(SE3d(SO3d(), {std::nan(""), 0, 0}), Matrix6d::Identity());
  EXPECT_INVALID_WITH(format_results(*results().job, damaged, results().metrics),
                      "the estimate at stamp 0.4 s is not finite");
}

}  // namespace
}  // namespace posemix
