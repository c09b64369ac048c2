// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "study/engine/run_study.hpp"
#include "study/monte_carlo/study.hpp"

/// Compares Table I to an independent prototype (another program, other random numbers, 100 runs).
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

/// value(method, level, key) of the study with its default seed.
class Table {
 public:
  explicit Table(const MonteCarloStudySettings& settings) {
    Ranks ranks;
    const auto run = run_study(ranks, [&] { return make_monte_carlo_study(settings); });
    const StudyReport report = run->study.report(run->results);
    const auto document = nlohmann::json::parse(report.files.front().content);
    for (const auto& row : document.at("rows")) rows_[row.at("method")].push_back(row);
  }

  double operator()(const std::string& method, std::size_t level, const char* key) const {
    return rows_.at(method).at(level).at(key).get<double>();
  }

 private:
  std::map<std::string, std::vector<nlohmann::json>> rows_;
};

// One test case, because it is all about one study. The means of both programs have a standard
// error, so the tolerance is three of the difference's; of an ANEES it is 0.028.
TEST(MonteCarloTable, AgreesWithTheOracleAndIsConsistentWithTheIteratedUpdate) {
  MonteCarloStudySettings settings;
  settings.runs = 100;
  settings.methods = {"riekf", "midway", "iterated"};
  const Table value(settings);
  const double tolerance = 3.0 * std::sqrt(2.0);
  for (const auto& [method, oracle] : kOracle) {
    for (std::size_t level = 0; level < oracle.size(); ++level) {
      SCOPED_TRACE(method + " at 10^" + std::to_string(level));
      EXPECT_NEAR(value(method, level, "robot_rotation_rmse_deg"), oracle[level].robot_deg,
                  tolerance * kRobotError[level]);
      EXPECT_NEAR(value(method, level, "object_rotation_rmse_deg"), oracle[level].object_deg,
                  tolerance * kObjectError[level]);
      if (method != "riekf") {
        EXPECT_NEAR(value(method, level, "anees"), oracle[level].anees, tolerance * 0.028);
      }
    }
  }
  for (std::size_t level = 0; level < 6; ++level) {
    SCOPED_TRACE(level);
    EXPECT_NEAR(value("iterated", level, "anees"), 1.0, 0.08);
    EXPECT_NEAR(value("iterated", level, "relative_nees"), 1.0, 0.08);
  }
  EXPECT_GT(value("midway", 5, "relative_nees"), 1.5) << "the linearized update is not consistent";
}

TEST(MonteCarloTable, TangentOfLargerIsMidwayToThreeDecimals) {
  MonteCarloStudySettings settings;
  settings.runs = 5;
  settings.methods = {"midway", "tangent_of_larger"};
  const Table value(settings);
  for (std::size_t level = 0; level < 6; ++level) {
    for (const char* key : {"robot_rotation_rmse_deg", "object_rotation_rmse_deg", "anees"}) {
      EXPECT_NEAR(value("tangent_of_larger", level, key), value("midway", level, key), 1e-3);
    }
  }
}

}  // namespace
}  // namespace posemix
