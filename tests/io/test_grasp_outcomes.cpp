// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/grasp_outcomes.hpp"

#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "posemix/testing/data.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

const std::string kHead =
    "# a comment\nscene_id,im_id,obj_id,npz_row,score,est_tx,est_ty,est_tz,est_qx,est_qy,est_qz,"
    "est_qw,gt_tx,gt_ty,gt_tz,gt_qx,gt_qy,gt_qz,gt_qw,grasp_small,grasp_large\n";
const std::string kPoses = "1,2,3,0,0,0.6,0.8,1,2,3.5,0,0,0,1,";

GraspOutcomes parse_outcomes(const std::string& text) {
  GraspOutcomes outcomes;
  parse_grasp_outcomes(text, "a_b.csv", "a", "b", outcomes);
  return outcomes;
}

TEST(GraspOutcomes, ReadsColumnsByName) {
  const GraspOutcomes read =
      parse_outcomes(kHead + "2,7,5,x,0.25," + kPoses + "1,\r\n2,8,5,x,0," + kPoses + "0.0,1\n");
  ASSERT_EQ(read.grippers, (std::vector<std::string>{"large", "small"}));
  ASSERT_EQ(read.trials.size(), 2U);
  const GraspTrial& trial = read.trials[0];
  EXPECT_EQ(trial.dataset, "a");
  EXPECT_EQ(trial.estimator, "b");
  EXPECT_EQ(trial.scene, 2);
  EXPECT_EQ(trial.image, 7);
  EXPECT_EQ(trial.object, 5);
  EXPECT_EQ(trial.score, 0.25);
  EXPECT_EQ(trial.estimate.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(trial.estimate.rotation().log().norm(), 2.0 * std::acos(0.8), 1e-12);
  EXPECT_EQ(trial.truth.translation(), Eigen::Vector3d(1, 2, 3.5));
  EXPECT_EQ(trial.outcomes, (std::vector<std::optional<bool>>{std::nullopt, true}));
  EXPECT_EQ(read.trials[1].outcomes, (std::vector<std::optional<bool>>{true, false}));
}

TEST(GraspOutcomes, SaysWhatIsWrongAndWhere) {
  const std::string row = "2,7,5,x,0.25," + kPoses;
  EXPECT_INVALID(parse_outcomes("# nothing\n"),
                 "a_b.csv: got no line, expected the names of the columns");
  EXPECT_INVALID(parse_outcomes("scene_id,im_id,score\n"),
                 "a_b.csv:1: got no column obj_id, expected one of that name");
  EXPECT_INVALID(parse_outcomes("scene_id,scene_id\n"),
                 "a_b.csv:1: got column \"scene_id\" again, expected every column once");
  EXPECT_INVALID(parse_outcomes(kHead + row + "1\n"), "a_b.csv:3: got 20 columns, expected 21");
  EXPECT_INVALID(parse_outcomes(kHead + "2,7,5,x,high," + kPoses + "1,\n"),
                 "a_b.csv:3: got score = \"high\", expected a finite number");
  EXPECT_INVALID(parse_outcomes(kHead + "2,7.5,5,x,1," + kPoses + "1,\n"),
                 "a_b.csv:3: got im_id = \"7.5\", expected an integer that is not negative");
  EXPECT_INVALID(parse_outcomes(kHead + row + "2,\n"),
                 "a_b.csv:3: got grasp_small = \"2\", expected 0, 1 or nothing");
  EXPECT_INVALID(parse_outcomes(kHead + "2,7,5,x,1,1,2,3,0,0,0,1,1,2,3.5,0,0,0.5,1,1,\n"),
                 "a_b.csv:3: got a quaternion of norm 1.11803 in gt_qx ... gt_qw, expected norm 1 "
                 "within 0.01");
  EXPECT_INVALID(parse_outcomes(kHead + row + "1,\n" + row + "1,\n"),
                 "a_b.csv:4: got object 5 in image 7 of scene 2 again, expected one estimate per "
                 "object and image");
}

TEST(GraspOutcomes, ReadsAFolderInTheOrderOfNames) {
  const testing::TemporaryFolder folder;
  EXPECT_INVALID_WITH(read_grasp_outcomes(folder / "none"), "none: no such folder");
  EXPECT_INVALID_WITH(read_grasp_outcomes(folder.path()), "got no estimate");
  const std::string head = kHead.substr(0, kHead.size() - 13);  // without grasp_large
  folder.put("consensus-driven-uncertainty/set_z.csv", kHead + "2,7,5,x,0," + kPoses + "1,0\n");
  folder.put("consensus-driven-uncertainty/set_a_1.csv", head + "\n2,7,5,x,0," + kPoses + "1\n");
  folder.put("consensus-driven-uncertainty/LICENSE", "");
  for (const std::string below : {"", "consensus-driven-uncertainty"}) {
    const GraspOutcomes read = read_grasp_outcomes(folder / below);
    ASSERT_EQ(read.trials.size(), 2U);
    EXPECT_EQ(read.trials[0].estimator, "a_1");
    EXPECT_EQ(read.trials[1].dataset, "set");
    ASSERT_EQ(read.grippers, (std::vector<std::string>{"small", "large"}));
    EXPECT_EQ(read.trials[0].outcomes, (std::vector<std::optional<bool>>{true, std::nullopt}));
    EXPECT_EQ(read.trials[1].outcomes, (std::vector<std::optional<bool>>{true, false}));
  }
  folder.put("consensus-driven-uncertainty/results.csv", kHead);
  EXPECT_INVALID_WITH(read_grasp_outcomes(folder.path()),
                      "results.csv: got this file name, expected DATASET_ESTIMATOR.csv");
}

/// Counts from the tables themselves: lines that are neither comment nor head, outcomes that are 1.
TEST(GraspOutcomes, OfTheDataFolder) {
  POSEMIX_REQUIRE_DATA();
  if (!std::filesystem::is_directory(*testing::data_dir() / "consensus-driven-uncertainty")) {
    GTEST_SKIP() << "no grasp outcomes";
  }
  const GraspOutcomes read = read_grasp_outcomes(*testing::data_dir());
  EXPECT_EQ(read.trials.size(), 8057U);
  EXPECT_EQ(read.grippers, (std::vector<std::string>{"parallel", "underactuated"}));
  const auto successes = std::count_if(read.trials.begin(), read.trials.end(), [](const auto& t) {
    return t.dataset == "lmo" && t.estimator == "epos" && t.outcomes[0] == true;
  });
  EXPECT_EQ(successes, 232);
}

}  // namespace
}  // namespace posemix
