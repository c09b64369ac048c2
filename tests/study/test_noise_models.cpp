// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "detector/simulated_detections.hpp"
#include "detector/simulated_slow_errors.hpp"
#include "posemix/config/detector_noise.hpp"
#include "posemix/config/toml_table.hpp"
#include "study/noise/study.hpp"

namespace posemix {
namespace {

using testing::detections_with_clutter;
using testing::recordings_with_modes;

ResidualSet residual_set(const std::vector<NoiseObservation>& observations, std::size_t recording) {
  ResidualSet set{.detector = "d", .object = "o", .recording = std::to_string(recording)};
  for (const NoiseObservation& each : observations) {
    set.truth.push_back(each.truth);
    set.detected.push_back(each.detected);
  }
  return set;
}

/// Recordings of a detector that gives a pose 90 degrees off in every recording, and another one
/// for a while in one of them.
TEST(NoiseStudy, ReportsModesThatSeveralRecordingsHave) {
  std::vector<ResidualSet> sets;
  for (const NoiseTrack& track : recordings_with_modes())
    sets.push_back(residual_set(observations_of({&track, 1}), sets.size()));
  const NoiseStudySettings settings{
      .fit = {.max_components = 1, .restarts = 2, .frame = NoiseFrame::ray}};
  const Study study = make_noise_study({.residuals = sets}, settings);
  const auto item = nlohmann::json::parse(study.run_item(0));
  ASSERT_EQ(item["modes"].size(), 2U);
  for (const auto& found : item["modes"]) {
    const bool wanted = found["axis_y"].get<double>() > 0.9;
    EXPECT_EQ(found["accepted"], wanted ? 1 : 0);
    EXPECT_NEAR(found["angle_deg"], wanted ? 90.0 : 150.0, 1.0);
    EXPECT_NEAR(found["recordings"], wanted ? 4.0 : 1.0, 0.3);
  }
  const auto& model = item["models"].back();
  EXPECT_TRUE(model["chosen"]);
  EXPECT_EQ(model["offsets"], 1);
  const auto& components = model["noise"];
  EXPECT_NEAR(components[1]["weight"], 0.15 * 2200.0 / 2400.0, 0.025);
  EXPECT_NEAR(components[1]["offset"][0][3], 0.01, 0.01);
  EXPECT_NEAR(components[1]["offset"][1][3], 0.02, 0.01);
}

/// The model that is written reads back with its slow error, and in the object's frame, which has
/// no clutter of its own, with the least weight of clutter.
TEST(NoiseStudy, WritesAModelForAFilterAsItIs) {
  RandomStream stream(4);
  testing::SlowSimulation simulation{
      .white_sd = Vector6d::Constant(0.02), .slow_sd = Vector6d::Constant(0.04), .angle_rad = 1.0};
  std::vector<ResidualSet> sets;
  for (std::size_t recording = 0; recording < 6; ++recording) {
    const testing::SlowRecording drawn = testing::slow_recording(simulation, stream);
    sets.push_back({.detector = "d",
                    .object = "o",
                    .recording = std::to_string(recording),
                    .truth = drawn.truth,
                    .detected = drawn.detected,
                    .stamps_s = drawn.stamps_s});
  }
  const Study study = make_noise_study({.residuals = sets}, NoiseStudySettings{});
  const std::vector<std::string> results{study.run_item(0)};
  const auto item = nlohmann::json::parse(results[0]);
  const StudyReport report = study.report(results);
  const auto file = std::find_if(report.files.begin(), report.files.end(),
                                 [](const auto& each) { return each.name == "noise_d_o.toml"; });
  ASSERT_NE(file, report.files.end());
  const TomlDocument document = TomlDocument::parse(file->content, "noise.toml");
  const DetectorNoise noise =
      read_detector_noise(document.root().get_table("noise").get_table("d_o"));
  document.finish();
  ASSERT_TRUE(noise.dependence().slow.has_value());
  EXPECT_EQ(item["slow_error"]["decay"], "angle");
  EXPECT_NEAR(degrees(noise.dependence().slow->correlation_angle_rad),
              item["slow_error"]["correlation_angle_deg"], 1e-9);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    const double sd = std::sqrt(noise.dependence().slow->covariance(at, at));
    EXPECT_NEAR(axis < 3 ? degrees(sd) : sd, item["slow_error"]["slow_sd"][axis], 1e-9);
  }
  EXPECT_NEAR(noise.clutter().weight, 1e-3, 1e-12);
  EXPECT_NE(file->content.find("# Of the slow error: rotation ["), std::string::npos);
}

/// Ranges between 0.4 and 1.6 m tell the frames apart, and gross errors ask for clutter.
TEST(NoiseStudy, ReportsTheCrossValidation) {
  std::vector<ResidualSet> sets;
  for (std::size_t recording = 0; recording < 3; ++recording)
    sets.push_back(residual_set(detections_with_clutter(500, 20 + recording), recording));
  const Study study = make_noise_study({.residuals = sets}, {.fit = {.max_components = 2,
                                                                     .restarts = 1,
                                                                     .frame = NoiseFrame::ray,
                                                                     .modes = false,
                                                                     .folds = 3}});
  const auto item = nlohmann::json::parse(study.run_item(0));
  ASSERT_EQ(item["validation"].size(), 12U);
  for (const auto& row : item["validation"]) {
    const bool right = row["frame"] == "ray" && row["clutter"] == 1;
    EXPECT_EQ(row["below_best"].get<double>() < 0.05, right) << row.dump();
  }
}

}  // namespace
}  // namespace posemix
