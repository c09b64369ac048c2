// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/consistency/study.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "study/consistency/trial.hpp"

/// A small version of the study: the defaults, told only the detector's model.
namespace posemix {
namespace {

using Json = nlohmann::json;

std::map<std::string, Json> rows_of(const ConsistencyStudySettings& settings) {
  const Study study = make_consistency_study(settings);
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  const Json report = Json::parse(study.report(results).files.front().content);
  std::map<std::string, Json> rows;
  for (const Json& row : report.at("rows")) rows[row.at("cell").get<std::string>()] = row;
  return rows;
}

// With a dozen recordings the standard error is 0.1 to 0.2; docs/results/consistency.md has the
// figures of the whole study.
TEST(ConsistencyStudy, TheDefaultsAreAsSureAsTheyAreRight) {
  const auto rows = rows_of({.runs = 12});
  ASSERT_EQ(rows.size(), consistency_cells().size());
  for (const auto& [name, row] : rows) {
    for (const char* pose : {"camera", "object", "relative"}) {
      const Json& anees = row.at(std::string(pose) + "_anees");
      const double value = anees.get<double>();
      std::printf("%s %s %.2f +- %.2f\n", name.c_str(), pose, value,
                  row.at(std::string(pose) + "_anees_error").get<double>());
      EXPECT_GT(value, 0.4) << name << " " << pose;
      EXPECT_LT(value, 2.0) << name << " " << pose;
    }
  }
}

TEST(ConsistencyStudy, KnownInstancesAreNotDuplicatedAfterAPause) {
  const auto rows = rows_of({.runs = 60, .cells = {"candidates_after_100_s"}});
  const Json& row = rows.at("candidates_after_100_s");
  EXPECT_GE(row.at("instances").get<int>(), 60);
  EXPECT_LE(row.at("duplicates").get<int>(), 1);
}

// The two are made of the same recordings.
TEST(ConsistencyStudy, TwoModesWithHonestWeightsBeatTheBestOne) {
  for (const std::string name : {"first_modes", "first_modes_in_runs"}) {
    const auto rows = rows_of({.runs = 60, .cells = {name, name + "_best_only"}});
    const Json& both = rows.at(name);
    const Json& best = rows.at(name + "_best_only");
    for (const char* key : {"right_mode", "rotation_deg", "position_m"}) {
      std::printf("%s %s %.4f, best only %.4f\n", name.c_str(), key, both.at(key).get<double>(),
                  best.at(key).get<double>());
    }
    EXPECT_GT(both.at("right_mode").get<double>(), best.at("right_mode").get<double>()) << name;
    EXPECT_LT(both.at("rotation_deg").get<double>(), best.at("rotation_deg").get<double>()) << name;
    // The wrong mode is half a turn about an axis through the object: its position is right.
    EXPECT_LT(both.at("position_m").get<double>(), 1.1 * best.at("position_m").get<double>());
    EXPECT_NEAR(both.at("mode_probability").get<double>(), both.at("right_mode").get<double>(), 0.1)
        << name;
  }
}

TEST(ConsistencyStudy, TheSameSeedIsTheSameRecording) {
  const auto& cell = consistency_cells().front();
  const ConsistencyTrial a = run_consistency_trial(cell, 3, 1);
  const ConsistencyTrial b = run_consistency_trial(cell, 3, 1);
  const ConsistencyTrial c = run_consistency_trial(cell, 3, 2);
  EXPECT_EQ(a.relative.nees, b.relative.nees);
  EXPECT_NE(a.relative.nees, c.relative.nees);
}

TEST(ConsistencyStudy, RefusesACellThatThereIsNot) {
  const TomlDocument document = TomlDocument::parse("cells = [\"wite\"]\n", "c.toml");
  try {
    read_consistency_settings(document.root());
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("c.toml:1: key 'cells' names a cell 'wite', expected"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace posemix
