// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "posemix/study/monte_carlo.hpp"
#include "posemix/study/run_study.hpp"

/// Table I against an independent prototype (another program, other random numbers, 100 runs).
namespace posemix {
namespace {

struct OracleRow {
  double robot_deg, object_deg, anees;
};
using OracleRows = std::array<OracleRow, 6>;

const std::map<std::string, OracleRows> kOracle{{"riekf",
                                                 {{{.927, 1.001, 1.042},
                                                   {1.656, 1.355, 1.045},
                                                   {2.867, 2.063, 1.034},
                                                   {4.776, 3.147, 1.067},
                                                   {7.507, 4.706, 1.528},
                                                   {10.061, 5.904, 3.243}}}},
                                                {"midway",
                                                 {{{.899, .929, 1.039},
                                                   {1.572, 1.264, 1.040},
                                                   {2.722, 1.955, 1.030},
                                                   {4.598, 3.089, 1.073},
                                                   {7.313, 4.703, 1.431},
                                                   {10.009, 5.919, 1.529}}}},
                                                {"iterated",
                                                 {{{.898, .928, 1.039},
                                                   {1.571, 1.263, 1.039},
                                                   {2.721, 1.953, 1.022},
                                                   {4.596, 3.089, .996},
                                                   {7.298, 4.685, .981},
                                                   {9.994, 5.910, .971}}}}};
/// Standard errors of the oracle's means over its 100 runs.
constexpr std::array<double, 6> kRobotError{.023, .036, .055, .085, .124, .144};
constexpr std::array<double, 6> kObjectError{.025, .043, .075, .130, .191, .237};

/// row(method, level) of the study.
class MonteCarloTable : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    MonteCarloSettings settings;
    settings.methods = {"riekf", "midway", "tangent_of_larger", "iterated"};
    Ranks ranks;
    const auto run = run_study(ranks, [&] { return make_monte_carlo_study(settings); });
    const StudyReport report = run->study.report(run->results);
    for (const auto& row : nlohmann::json::parse(report.files.front().content).at("rows")) {
      rows_[row.at("method")].push_back(row);
    }
  }

  static double value(const std::string& method, std::size_t level, const char* key) {
    return rows_.at(method).at(level).at(key).get<double>();
  }

  static std::map<std::string, std::vector<nlohmann::json>> rows_;
};

std::map<std::string, std::vector<nlohmann::json>> MonteCarloTable::rows_;

TEST_F(MonteCarloTable, ErrorsAgreeWithTheOracle) {
  for (const auto& [method, oracle] : kOracle) {
    for (std::size_t level = 0; level < oracle.size(); ++level) {
      SCOPED_TRACE(method + " at 10^" + std::to_string(level));
      EXPECT_NEAR(value(method, level, "robot_rotation_rmse_deg"), oracle[level].robot_deg,
                  3 * kRobotError[level]);
      EXPECT_NEAR(value(method, level, "object_rotation_rmse_deg"), oracle[level].object_deg,
                  3 * kObjectError[level]);
    }
  }
}

TEST_F(MonteCarloTable, ConsistencyAgreesWithTheOracle) {
  for (std::size_t level = 0; level < 6; ++level) {
    SCOPED_TRACE(level);
    EXPECT_NEAR(value("midway", level, "anees"), kOracle.at("midway")[level].anees, 0.06);
    EXPECT_NEAR(value("iterated", level, "anees"), kOracle.at("iterated")[level].anees, 0.06);
  }
}

TEST_F(MonteCarloTable, TheIteratedUpdateIsConsistentAtEveryLevel) {
  for (std::size_t level = 0; level < 6; ++level) {
    SCOPED_TRACE(level);
    EXPECT_NEAR(value("iterated", level, "anees"), 1.0, 0.08);
    EXPECT_NEAR(value("iterated", level, "relative_nees"), 1.0, 0.08);
  }
  EXPECT_GT(value("midway", 5, "relative_nees"), 1.5) << "the linearized update is not";
}

TEST_F(MonteCarloTable, TangentOfLargerIsMidwayToThreeDecimals) {
  for (std::size_t level = 0; level < 6; ++level) {
    for (const char* key : {"robot_rotation_rmse_deg", "object_rotation_rmse_deg", "anees"}) {
      EXPECT_NEAR(value("tangent_of_larger", level, key), value("midway", level, key), 1e-3);
    }
  }
}

}  // namespace
}  // namespace posemix
