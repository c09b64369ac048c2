// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "posemix/io/grasp_outcomes.hpp"
#include "posemix/testing/data.hpp"
#include "study/grasp/study.hpp"

namespace posemix {
namespace {

/// Bounds from the scores of a prototype on the same tables, over all held-out grasps (split
/// `all`), and over those in a new scene (split `scene`).
TEST(GraspStudyData, PredictsGraspsOfTheDataFolder) {
  POSEMIX_REQUIRE_DATA();
  if (!std::filesystem::is_directory(*testing::data_dir() / "consensus-driven-uncertainty")) {
    GTEST_SKIP() << "no grasp outcomes";
  }
  GraspStudySettings quick;  // a quarter of the work; the figures hardly change
  quick.bootstrap_regions = 4;
  quick.region.starts = 2;
  quick.consensus.draws_per_member = 160;
  const Study study = make_grasp_study(read_grasp_outcomes(*testing::data_dir()), {}, quick);
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  const auto rows = nlohmann::json::parse(study.report(results).files.front().content)["rows"];
  const auto score = [&](const char* method, const char* split, const char* what) {
    for (const auto& row : rows) {
      if (row["method"] == method && row["split"] == split && row["object"] == "all" &&
          row["gripper"] == "all" && row["estimator"] == "all") {
        return row[what].get<double>();
      }
    }
    return std::nan("");
  };
  EXPECT_NEAR(score("base_rate", "all", "brier"), 0.172, 0.01);
  for (const char* split : {"all", "scene"}) {
    EXPECT_GE(score("region_at_true_error", split, "accuracy"), 0.88) << split;
    EXPECT_LE(score("mixture", split, "brier"), 0.135) << split;
    EXPECT_GE(score("mixture", split, "auc"), 0.78) << split;
    EXPECT_LT(score("mixture", split, "brier"), score("trimmed_gaussian", split, "brier")) << split;
    EXPECT_LT(score("mixture", split, "brier"), score("logistic", split, "brier")) << split;
    EXPECT_LT(score("mixture", split, "brier"), score("gaussian", split, "brier")) << split;
  }
  EXPECT_LE(score("mixture", "all", "calibration_error"), 0.05);
}

}  // namespace
}  // namespace posemix
