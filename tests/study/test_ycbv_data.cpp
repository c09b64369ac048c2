// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The study on the recorded sequences against runs of the sequence files.
#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "posemix/base/statistics.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/testing/data.hpp"
#include "study/ycbv/study.hpp"

namespace posemix {
namespace {

using Json = nlohmann::json;

Json rows_of_study(const YcbvStudySettings& settings) {
  const Study study = make_ycbv_study(settings);
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  return Json::parse(study.report(results).files.at(0).content).at("rows");
}

Metrics run_config(const std::string& name, const std::vector<std::string>& overrides) {
  TomlDocument document =
      TomlDocument::load(std::string(POSEMIX_SOURCE_DIR "/configs/") + name + ".toml");
  for (const std::string& each : overrides) document.apply_override(each);
  const SlamJob job = read_slam_job(document, {*testing::data_dir()});
  return evaluate(job.sequence, run(job.sequence, job.camera_prior, job.models, job.settings));
}

void expect_row(const Json& row, const Metrics& metrics, std::size_t object) {
  const ObjectMetrics& errors = metrics.objects[object];
  EXPECT_EQ(row["object"], errors.id);
  EXPECT_EQ(row["detections"], errors.detections);
  EXPECT_EQ(row["camera_rotation_rmse_deg"], *metrics.camera.rotation_rmse_deg);
  EXPECT_EQ(row["camera_position_rmse_cm"], 100 * *metrics.camera.position_rmse_m);
  EXPECT_EQ(row["relative_rotation_rmse_deg"], *errors.relative.rotation_rmse_deg);
  EXPECT_EQ(row["object_position_rmse_cm"], 100 * *errors.world.position_rmse_m);
  EXPECT_EQ(row["relative_anees"], *errors.relative_anees);
}

TEST(YcbvData, Sequence0022IsAsTheSequenceFileRunsIt) {
  POSEMIX_REQUIRE_DATA();
  const Json rows = rows_of_study(
      {.data = *testing::data_dir(), .methods = {"midway", "published"}, .sequences = {"0022"}});
  const Metrics midway = run_config(
      "ycbv-0022", {"filter.method=gm-iekf", "objects.0.noise=gaussian", "objects.1.noise=gaussian",
                    "objects.2.noise=gaussian", "objects.3.noise=gaussian",
                    "filter.noise_use=joint", "filter.update=linearized",
                    "filter.gate_probability=1", "filter.summary=merge_two_largest"});
  const Metrics published = run_config("ycbv-0022-paper", {});
  ASSERT_GE(rows.size(), 8U);
  for (std::size_t i = 0; i < 4; ++i) {
    expect_row(rows[i], midway, i);
    expect_row(rows[4 + i], published, i);
  }
  // The midway paper's Table II: 2.82 cm, 1.82 deg.
  EXPECT_NEAR(rows[7]["camera_position_log_rmse_cm"], 2.82, 0.005);
  EXPECT_NEAR(rows[7]["camera_rotation_rmse_deg"], 1.82, 0.005);
}

TEST(YcbvData, DopePairsAreAsTheSequenceFileRunsThem) {
  POSEMIX_REQUIRE_DATA();
  for (const auto& [object, sequence] :
       {std::pair<std::string, std::string>{"003_cracker_box_16k", "0035"},
        std::pair<std::string, std::string>{"010_potted_meat_can_16k", "0060"}}) {
    const Json rows = rows_of_study({.data = *testing::data_dir(),
                                     .methods = {"riekf", "default"},
                                     .sequences = {sequence},
                                     .objects = {object}});
    const std::vector<std::string> pair{"object=" + object, "sequence=" + sequence};
    std::vector<std::string> riekf = pair;
    riekf.insert(riekf.end(), {"filter.method=riekf", "objects.0.noise=gaussian"});
    expect_row(rows[0], run_config("ycbv-dope", riekf), 0);
    expect_row(rows[1], run_config("ycbv-dope", pair), 0);
  }
}

/// The row of the summary of one method over the DOPE pairs.
Json dope_summary(const std::string& method) {
  const Study study = make_ycbv_study(
      {.data = *testing::data_dir(),
       .methods = {"odometry", "published_offline", method},
       .objects = {"003_cracker_box_16k", "004_sugar_box_16k", "010_potted_meat_can_16k"}});
  std::vector<std::string> results;
  for (std::size_t item = 0; item < study.items; ++item) results.push_back(study.run_item(item));
  const StudyReport report = study.report(results);
  for (const StudyFile& file : report.files) {
    if (file.name != "study.json") continue;
    const Json json = Json::parse(file.content);
    for (const Json& row : json["summary"]) {
      if (row["method"] == method) return row;
    }
  }
  return {};
}

// Causal estimates are better than published offline optimisation (ACT, 15.1 px) in the median, and
// the camera is on average no worse than its odometry. The last map follows the odometry.
TEST(YcbvData, TheDefaultSurvivesRealDetections) {
  POSEMIX_REQUIRE_DATA();
  const Json row = dope_summary("default");
  ASSERT_FALSE(row.is_null());
  std::printf("%s\n", row.dump().c_str());
  EXPECT_LE(row["pixel_median"], 13.2);
  EXPECT_LE(row["pixel_median_last_map"], 15.0);
  EXPECT_GE(row["better_than_act"], 17);
  EXPECT_LE(row["camera_rotation_over_odometry"], 1.02);
  EXPECT_LE(row["camera_position_over_odometry"], 1.02);
  EXPECT_GE(row["recovered"], 12);
}

// Each recording is one or two looks, so that a perfect filter has three quarters of them within a
// factor of two.
TEST(YcbvData, TheDefaultIsAsSureAsItIsRight) {
  POSEMIX_REQUIRE_DATA();
  const Json rows = rows_of_study(
      {.data = *testing::data_dir(),
       .methods = {"default"},
       .objects = {"003_cracker_box_16k", "004_sugar_box_16k", "010_potted_meat_can_16k"}});
  for (const char* column : {"camera_anees", "right_mode_anees"}) {
    std::vector<double> values;
    for (const Json& row : rows) {
      const auto sequence = row["sequence"].get<std::string>();
      if (!row[column].is_null() && sequence != "median" && sequence != "mean")
        values.push_back(row[column]);
    }
    ASSERT_GE(values.size(), 28U) << column;
    const auto within =
        std::count_if(values.begin(), values.end(), [](double v) { return v > 0.5 && v < 2.0; });
    const double share = static_cast<double>(within) / static_cast<double>(values.size());
    std::printf("%s: median %.2f, mean %.2f, worst %.2f, within 0.5 to 2 %.2f\n", column,
                median(values), mean(values), *std::max_element(values.begin(), values.end()),
                share);
    EXPECT_GE(share, 0.6) << column;
    EXPECT_GT(median(values), 0.8) << column;
    EXPECT_LT(median(values), 1.25) << column;
  }
}

TEST(YcbvData, TheDefaultIsNearThePaperOn0022) {
  POSEMIX_REQUIRE_DATA();
  const Metrics metrics = run_config("ycbv-0022", {});
  std::printf("camera %.3f deg, mug relative %.3f deg\n", *metrics.camera.rotation_rmse_deg,
              *metrics.objects[3].relative.rotation_rmse_deg);
  EXPECT_LE(*metrics.camera.rotation_rmse_deg, 2.6);
  EXPECT_LE(*metrics.objects[3].relative.rotation_rmse_deg, 2.8);
}

}  // namespace
}  // namespace posemix
