// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/divergence/study.hpp"

#include <array>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "posemix/divergence/paper_grid.hpp"

namespace posemix {
namespace {

struct OracleRow {
  double phi_deg, kl_midway, kl_anchor_1, kl_anchor_2, isd_midway, isd_anchor_1, isd_anchor_2;
};

// An independent prototype: exact logarithm, composite Gauss-Legendre over radius and polar angle,
// unchanged to 1e-10 by a grid of twice the density. Columns after the midway's are differences
// from it, for the tangent space of the first and of the second component.
constexpr std::array<OracleRow, 12> kOracle{
    {{5, 0.14636029, 1.64e-7, 1.63e-7, 2.8578, 1.81e-3, -1.81e-3},
     {10, 0.24758524, 2.63e-6, 2.59e-6, 3.9783, 4.33e-3, -4.29e-3},
     {15, 0.37745845, 1.344e-5, 1.307e-5, 4.9613, 6.03e-3, -5.87e-3},
     {20, 0.54121480, 4.30e-5, 4.10e-5, 5.8951, 7.34e-3, -6.97e-3},
     {25, 0.71344138, 1.065e-4, 9.93e-5, 6.6057, 8.63e-3, -7.92e-3},
     {30, 0.87336600, 2.249e-4, 2.037e-4, 7.1003, 1.005e-2, -8.84e-3},
     {35, 1.01547454, 4.255e-4, 3.723e-4, 7.4516, 1.168e-2, -9.75e-3},
     {40, 1.14136899, 7.435e-4, 6.250e-4, 7.7118, 1.356e-2, -1.068e-2},
     {45, 1.25388507, 1.223e-3, 9.82e-4, 7.9116, 1.574e-2, -1.160e-2},
     {50, 1.35544388, 1.921e-3, 1.464e-3, 8.0695, 1.825e-2, -1.253e-2},
     {55, 1.44791930, 2.905e-3, 2.088e-3, 8.1973, 2.115e-2, -1.345e-2},
     {60, 1.53276029, 4.260e-3, 2.868e-3, 8.3027, 2.447e-2, -1.436e-2}}};

std::map<std::string, DivergenceRow> rows_at(double phi_deg) {
  std::map<std::string, DivergenceRow> rows;
  for (const DivergenceRow& row : merge_divergences({}, phi_deg)) rows.emplace(row.rule, row);
  return rows;
}

TEST(DivergenceStudy, AgreesWithTheOracleAtEveryAngle) {
  for (const OracleRow& oracle : kOracle) {
    SCOPED_TRACE(oracle.phi_deg);
    const auto rows = rows_at(oracle.phi_deg);
    const DivergenceRow& midway = rows.at("midway");
    const DivergenceRow& first = rows.at("tangent_of_larger_anchor_1");
    const DivergenceRow& second = rows.at("tangent_of_larger_anchor_2");
    const double kl = midway.kl.value;
    EXPECT_NEAR(kl / oracle.kl_midway, 1.0, 4e-8);
    EXPECT_NEAR(first.kl.value, kl + oracle.kl_anchor_1, 1e-5 * kl);
    EXPECT_NEAR(second.kl.value, kl + oracle.kl_anchor_2, 1e-5 * kl);
    EXPECT_NEAR((first.kl.value - kl) / oracle.kl_anchor_1, 1.0, 5e-3) << "three digits given";
    EXPECT_NEAR((second.kl.value - kl) / oracle.kl_anchor_2, 1.0, 5e-3);
    const double isd = midway.isd.value;
    EXPECT_NEAR(isd / oracle.isd_midway, 1.0, 2e-5) << "five digits given";
    EXPECT_NEAR(first.isd.value - isd, oracle.isd_anchor_1, 1e-5 * isd);
    EXPECT_NEAR(second.isd.value - isd, oracle.isd_anchor_2, 1e-5 * isd);
    for (const auto& [rule, row] : rows) {
      EXPECT_TRUE(row.kl.converged && row.isd.converged) << rule;
    }
  }
}

// The claim of the paper holds for the Kullback-Leibler divergence; for the integral square
// distance it depends on which component is taken as the larger of two equal weights.
TEST(DivergenceStudy, TheClaimOnTheSquareDistanceDependsOnTheAnchor) {
  for (const OracleRow& oracle : kOracle) {
    const auto rows = rows_at(oracle.phi_deg);
    const DivergenceRow& midway = rows.at("midway");
    EXPECT_GT(rows.at("tangent_of_larger_anchor_1").kl.value, midway.kl.value);
    EXPECT_GT(rows.at("tangent_of_larger_anchor_2").kl.value, midway.kl.value);
    EXPECT_GT(rows.at("tangent_of_larger_anchor_1").isd.value, midway.isd.value);
    EXPECT_LT(rows.at("tangent_of_larger_anchor_2").isd.value, midway.isd.value);
  }
}

TEST(DivergenceStudy, MomentMatchingIsAlmostMidway) {
  for (const double phi : {5.0, 30.0, 60.0}) {
    const auto rows = rows_at(phi);
    EXPECT_NEAR(rows.at("moment_matched").kl.value / rows.at("midway").kl.value, 1.0, 2e-4);
  }
}

TEST(DivergenceStudy, WritesOneRowPerAngleAndRule) {
  DivergenceStudySettings settings;
  settings.phi_deg = {10, 50};
  const Study study = make_divergence_study(settings);
  ASSERT_EQ(study.items, 2U);
  const std::vector<std::string> results{study.run_item(0), study.run_item(1)};
  const StudyReport report = study.report(results);
  ASSERT_EQ(report.files.front().name, "study.json");
  const auto json = nlohmann::json::parse(report.files.front().content);
  EXPECT_EQ(json.at("schema"), 1);
  EXPECT_EQ(json.at("study"), "divergence");
  ASSERT_EQ(json.at("rows").size(), 8U);
  EXPECT_EQ(json.at("rows")[4].at("phi_deg"), 50.0);
  EXPECT_EQ(json.at("rows")[4].at("rule"), "midway");
  EXPECT_NEAR(json.at("rows")[4].at("kl").get<double>(), 1.35544388, 1e-7);
  EXPECT_NEAR(json.at("rows")[4].at("isd").get<double>(), 8.0695, 1e-4);
}

TEST(DivergenceStudy, WritesThePapersGridWhereAskedFor) {
  DivergenceStudySettings settings;
  settings.phi_deg = {60};
  settings.paper_grid_step_deg = 6;
  const Study study = make_divergence_study(settings);
  const std::vector<std::string> results{study.run_item(0)};
  const StudyReport report = study.report(results);
  EXPECT_EQ(report.files.back().name, "paper-grid.csv");
  EXPECT_NE(report.files.back().content.find("phi_deg,rule,kl,isd,mass\n60,midway,1.4"),
            std::string::npos)
      << report.files.back().content;
}

TEST(DivergenceStudy, ReadsSettings) {
  const TomlDocument document = TomlDocument::parse(
      "phi_deg = [1, 2]\nweights = [0.2, 0.8]\ndirection = [0, 0, 1]\nfirst_sd_deg = 3\n"
      "second_sd_deg = [1, 2, 3]\nrelative_tolerance = 1e-5\n",
      "settings.toml");
  const DivergenceStudySettings settings = read_divergence_settings(document.root());
  document.finish();
  EXPECT_EQ(settings.phi_deg, (std::vector<double>{1, 2}));
  EXPECT_DOUBLE_EQ(settings.weights[1], 0.8);
  EXPECT_DOUBLE_EQ(settings.first_sd_rad[2], radians(3.0));
  EXPECT_DOUBLE_EQ(settings.second_sd_rad[1], radians(2.0));
  EXPECT_DOUBLE_EQ(settings.relative_tolerance, 1e-5);
}

TEST(DivergenceStudy, RefusesSettingsThatMakeNoSense) {
  for (const char* text : {"phi_deg = []", "weights = [1, -1]", "first_sd_deg = 0",
                           "second_sd_deg = [1, 2]", "relative_tolerance = 1"}) {
    const TomlDocument document = TomlDocument::parse(text, "settings.toml");
    EXPECT_THROW(read_divergence_settings(document.root()), InvalidInput) << text;
  }
}

}  // namespace
}  // namespace posemix
