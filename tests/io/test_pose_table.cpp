// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/pose_table.hpp"

#include <gtest/gtest.h>

#include "expect_invalid.hpp"

namespace posemix {
namespace {

const std::string kTableHeader =
    "# source\nim_id,scene_id,obj_id,est_tx,est_ty,est_tz,est_qx,est_qy,est_qz,est_qw,more\n";
const std::string kTableRow = "12,48,14,0.1,-0.2,1.5,0,0,1,0,x\n";

std::map<std::int64_t, SE3d> parse_table(const std::string& text,
                                         const std::string& prefix = "est_") {
  return parse_pose_table(text, "t.csv", {48, 14}, prefix);
}

TEST(PoseTable, SelectsSceneAndObject) {
  const auto poses =
      parse_table(kTableHeader + "12,48,15,1,1,1,0,0,0,1,x\n12,49,14,,,,,,,,\n" + kTableRow);
  ASSERT_EQ(poses.size(), 1U);
  const SE3d& pose = poses.at(12);
  EXPECT_EQ(pose.translation(), Eigen::Vector3d(0.1, -0.2, 1.5));
  // Half a turn about z.
  EXPECT_LT((pose.rotation() * Eigen::Vector3d(1, 2, 3) - Eigen::Vector3d(-1, -2, 3)).norm(),
            1e-15);
}

TEST(PoseTable, RefusesWhatDoesNotFit) {
  EXPECT_INVALID(parse_table(kTableHeader),
                 "t.csv: got no row of scene 48 and object 14, expected at least one");
  EXPECT_INVALID(
      parse_table(kTableHeader + kTableRow + kTableRow),
      "t.csv:4: got object 14 in image 12 of scene 48 again, expected one row per object "
      "and image");
  EXPECT_INVALID_WITH(parse_table(kTableHeader + kTableRow, "gt_"), "t.csv:2: got no column gt_tx");
  EXPECT_INVALID_WITH(parse_table("scene_id,obj_id\n"), "got no column im_id");
  EXPECT_INVALID_WITH(parse_table(kTableHeader + "12,48,14,0,0,1,0,0,2,0,x\n"),
                      "a quaternion of norm 2");
  // In rows of other scenes, too.
  EXPECT_INVALID_WITH(parse_table(kTableHeader + "12,49,mug,,,,,,,,\n" + kTableRow), "t.csv:3: ");
}

}  // namespace
}  // namespace posemix
