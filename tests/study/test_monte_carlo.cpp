// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/monte_carlo/study.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

MonteCarloStudySettings small_settings() {
  MonteCarloStudySettings settings;
  settings.runs = 3;
  settings.noise_exponents = {0, 4};
  settings.methods = monte_carlo_methods();
  settings.path.detections = 20;
  return settings;
}

std::vector<std::string> all_results(const Study& study) {
  std::vector<std::string> results;
  for (std::size_t item = 0; item < study.items; ++item) results.push_back(study.run_item(item));
  return results;
}

TEST(MonteCarlo, RunsEveryMethodOnTheSameRecording) {
  const MonteCarloStudySettings settings = small_settings();
  const auto errors = run_monte_carlo(settings, 4, 1);
  ASSERT_EQ(errors.size(), settings.methods.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    SCOPED_TRACE(settings.methods[i]);
    EXPECT_GT(errors[i].robot_rotation_rmse_deg, 0.01);
    EXPECT_LT(errors[i].robot_rotation_rmse_deg, 60.0);
    EXPECT_GT(errors[i].anees, 0.01);
    EXPECT_LT(errors[i].anees, 20.0);
  }
}

TEST(MonteCarlo, ARunDoesNotDependOnTheOtherMethods) {
  MonteCarloStudySettings settings = small_settings();
  const auto all = run_monte_carlo(settings, 0, 2);
  settings.methods = {"iterated"};
  const auto alone = run_monte_carlo(settings, 0, 2);
  const auto at = std::find(monte_carlo_methods().begin(), monte_carlo_methods().end(), "iterated");
  const auto& same = all[static_cast<std::size_t>(at - monte_carlo_methods().begin())];
  EXPECT_EQ(alone[0].anees, same.anees);
  EXPECT_EQ(alone[0].robot_rotation_rmse_deg, same.robot_rotation_rmse_deg);
}

// With negligible odometry noise and a sharp detector, the remaining errors are those of the start,
// which is unobservable; the covariance must include them.
TEST(MonteCarlo, IsConsistentWhereOnlyTheStartIsUncertain) {
  MonteCarloStudySettings settings = small_settings();
  settings.methods = {"iterated"};
  settings.detector = DetectorNoise({{.covariance = 1e-8 * Matrix6d::Identity()}});
  double sum = 0.0;
  constexpr std::size_t kRuns = 100;
  for (std::size_t run = 0; run < kRuns; ++run) {
    sum += run_monte_carlo(settings, -6, run)[0].anees;
  }
  const double sd = std::sqrt(2.0 / (6.0 * kRuns));  // six of the twelve are left
  EXPECT_NEAR(sum / kRuns, 1.0, 4 * sd);
}

TEST(MonteCarlo, ReportHasARowPerMethodAndLevel) {
  const MonteCarloStudySettings settings = small_settings();
  const Study study = make_monte_carlo_study(settings);
  EXPECT_EQ(study.items, 6U);
  const StudyReport report = study.report(all_results(study));
  const auto json = nlohmann::json::parse(report.files.front().content);
  ASSERT_EQ(json.at("rows").size(), 2 * settings.methods.size());
  for (const auto& row : json.at("rows")) {
    EXPECT_EQ(row.at("runs"), 3);
    for (const char* key : {"robot_rotation_rmse_deg", "object_rotation_rmse_deg", "anees",
                            "relative_nees", "noise_exponent"}) {
      EXPECT_TRUE(row.at(key).is_number()) << key;
    }
  }
  const double anees = run_monte_carlo(settings, 0, 0)[0].anees +
                       run_monte_carlo(settings, 0, 1)[0].anees +
                       run_monte_carlo(settings, 0, 2)[0].anees;
  EXPECT_DOUBLE_EQ(json.at("rows")[0].at("anees").get<double>(), anees / 3);
}

TEST(MonteCarlo, OneRunHasNoStandardError) {
  MonteCarloStudySettings settings = small_settings();
  settings.runs = 1;
  const Study study = make_monte_carlo_study(settings);
  const StudyReport report = study.report(all_results(study));
  const auto json = nlohmann::json::parse(report.files.front().content);
  EXPECT_TRUE(json.at("rows")[0].at("anees_standard_error").is_null());
  EXPECT_EQ(json.dump().find("nan"), std::string::npos) << json.at("notes");
  for (const StudyFile& file : report.files)
    EXPECT_EQ(file.content.find("-nan"), std::string::npos) << file.name;
}

TEST(MonteCarlo, ReadsSettings) {
  const TomlDocument document = TomlDocument::parse(
      "runs = 7\nmethods = [\"no-merge-64\", \"iterated\"]\nnoise_exponents = [1.5]\nseed = 9\n"
      "max_components = 2\n[path]\nradius_m = 2\nturns = 2\ndetections = 30\n"
      "[odometry]\nrotation_sd_deg = 0.1\ntranslation_sd_m = 0.01\n"
      "[detector]\ncomponents = [{rotation_sd_deg = 2, translation_sd_m = 0.02, frame = "
      "\"camera\"}]\n",
      "settings.toml");
  const MonteCarloStudySettings settings = read_monte_carlo_settings(document.root());
  document.finish();
  EXPECT_EQ(settings.runs, 7U);
  EXPECT_EQ(settings.methods, (std::vector<std::string>{"no_merge_64", "iterated"}));
  EXPECT_EQ(settings.noise_exponents, std::vector<double>{1.5});
  EXPECT_EQ(settings.seed, 9U);
  EXPECT_EQ(settings.path.detections, 30U);
  EXPECT_DOUBLE_EQ(settings.odometry(3, 3), 1e-4);
  EXPECT_EQ(settings.detector.components().size(), 1U);
}

TEST(MonteCarlo, RefusesSettingsThatMakeNoSense) {
  for (const char* text :
       {"runs = 0", "methods = [\"kalman\"]", "methods = []", "methods = [\"midway\", \"midway\"]",
        "noise_exponents = [20]", "[path]\nradius_m = 0"}) {
    const TomlDocument document = TomlDocument::parse(text, "settings.toml");
    EXPECT_THROW(read_monte_carlo_settings(document.root()), InvalidInput) << text;
  }
}

}  // namespace
}  // namespace posemix
