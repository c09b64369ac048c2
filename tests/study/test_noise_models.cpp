// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "detector/simulated_detections.hpp"
#include "study/noise/study.hpp"

namespace posemix {
namespace {

using testing::detect_along_ray;
using testing::detect_nothing;
using testing::detections_with_clutter;
using testing::pose_before_camera;
using testing::ray_deviations;

/// Recordings of a detector that gives a pose 90 degrees off in every recording, and another one
/// for a while in one of them.
TEST(NoiseStudy, ReportsModesThatSeveralRecordingsHave) {
  RandomStream stream(7);
  const SE3d mode(SO3d::exp({0.0, radians(90.0), 0.0}), {0.01, 0.02, 0.0});
  const SE3d run(SO3d::exp({radians(150.0), 0.0, 0.0}), {0.0, 0.0, 0.0});
  std::vector<ResidualSet> sets;
  for (int recording = 0; recording < 4; ++recording) {
    ResidualSet set{.detector = "d", .object = "o", .recording = std::to_string(recording)};
    for (int i = 0; i < 600; ++i) {
      const SE3d truth = pose_before_camera(stream);
      const double u = stream.uniform();
      SE3d detected = detect_along_ray(truth, ray_deviations(), stream);
      if (u < 0.15) detected = detect_along_ray(truth * mode, ray_deviations(), stream);
      if (u > 0.85) detected = detect_nothing(truth, stream);
      if (recording == 2 && i < 200)
        detected = detect_along_ray(truth * run, ray_deviations(), stream);
      set.truth.push_back(truth);
      set.detected.push_back(detected);
    }
    sets.push_back(std::move(set));
  }
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

/// Ranges between 0.4 and 1.6 m tell the frames apart, and gross errors ask for clutter.
TEST(NoiseStudy, ReportsTheCrossValidation) {
  RandomStream stream(8);
  std::vector<ResidualSet> sets;
  for (int recording = 0; recording < 3; ++recording) {
    ResidualSet set{.detector = "d", .object = "o", .recording = std::to_string(recording)};
    for (const NoiseObservation& each : detections_with_clutter(500, 20 + recording)) {
      set.truth.push_back(each.truth);
      set.detected.push_back(each.detected);
    }
    sets.push_back(std::move(set));
  }
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
