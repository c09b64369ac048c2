// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/bop.hpp"

#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "posemix/testing/data.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

const std::string kBopHeader = "scene_id,im_id,obj_id,score,R,t,time\n";
const std::string kBopRow = "48,12,14,0.5,0 -1 0 1 0 0 0 0 1,100 -200 1500,-1\n";

BopDetections parse_detections(const std::string& text) {
  return parse_bop(text, "b.csv", {48, 14});
}

TEST(Bop, MillimetresBecomeMetres) {
  const BopDetections detections = parse_detections(kBopHeader + kBopRow);
  ASSERT_EQ(detections.size(), 1U);
  const ScoredPose& only = detections.at(12).at(0);
  EXPECT_EQ(only.score, 0.5);
  EXPECT_LT((only.pose.translation() - Eigen::Vector3d(0.1, -0.2, 1.5)).norm(), 1e-15);
  const Eigen::Vector3d image_of_x = only.pose.rotation() * Eigen::Vector3d::UnitX().eval();
  EXPECT_LT((image_of_x - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(Bop, SelectsSceneAndObject) {
  const std::string others =
      "49,12,14,1,1 0 0 0 1 0 0 0 1,0 0 1,1\r\n48,12,15,1,2 0 0 0 2 0 0 0 2,0 0 1,1\n\n";
  const std::string second = "48, 12, 14, 0.25, 1 0 0 0 1 0 0 0 1, 0 0 1, 1.5";
  const BopDetections detections = parse_detections(kBopRow + others + second);
  ASSERT_EQ(detections.at(12).size(), 2U);
  EXPECT_EQ(detections.at(12)[0].score, 0.5);
  EXPECT_EQ(detections.at(12)[1].score, 0.25);
  EXPECT_INVALID(parse_detections(kBopHeader + others),
                 "b.csv: got no row of scene 48 and object 14, expected at least one");
}

TEST(Bop, AllRows) {
  const std::string other = "49,12,15,1,1 0 0 0 1 0 0 0 1,0 0 1000,1\r\n";
  const std::vector<BopRow> rows = parse_bop_rows(kBopHeader + kBopRow + "\n" + other, "b.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].object, 14);
  EXPECT_EQ(rows[0].score, 0.5);
  EXPECT_EQ(rows[1].scene, 49);
  EXPECT_EQ(rows[1].image, 12);
  EXPECT_EQ(rows[1].pose.translation().z(), 1.0);
  EXPECT_INVALID(parse_bop_rows(kBopHeader, "b.csv"), "b.csv: got no row, expected at least one");
  EXPECT_INVALID_WITH(parse_bop_rows(kBopRow + "1,2,3,4,1 0 0 0 1 0 0 0 2,0 0 0,1\n", "b.csv"),
                      "b.csv:2: rotation matrix is not orthonormal");
}

TEST(Bop, ErrorsOfFarPosesNameTheRow) {
  const std::string far = "48,13,14,0.5,1 0 0 0 1 0 0 0 1,0 0 8.2e13,-1\n";
  EXPECT_INVALID(parse_bop_rows(kBopHeader + kBopRow + far, "b.csv"),
                 "b.csv:3: got t = \"0 0 8.2e13\" with 8.2e+13 mm, expected millimetres, at most "
                 "1e+11");
  EXPECT_INVALID_WITH(parse_detections(kBopRow + far), "b.csv:2: got t = ");
}

TEST(Bop, RejectsDamagedRows) {
  const auto with = [](std::string row, const std::string& from, const std::string& to) {
    return kBopHeader + row.replace(row.find(from), from.size(), to);
  };
  EXPECT_INVALID(parse_detections(""),
                 "b.csv: got no row of scene 48 and object 14, expected at least one");
  EXPECT_INVALID(parse_detections(kBopHeader + "48,12,14,0.5,0 -1 0 1 0 0 0 0 1,100 -200\n"),
                 "b.csv:2: got 6 columns, expected 7: scene_id,im_id,obj_id,score,R,t,time");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, ",-1\n", ",-1,3\n")),
                      "b.csv:2: got 8 columns");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, "48", "4.8")),
                      "b.csv:2: got scene_id = \"4.8\"");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, "12", "-12")), "got im_id = \"-12\"");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, "14", "")), "got obj_id = \"\"");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, "0.5", "nan")), "got score = \"nan\"");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, " 0 1,", " 1,")),
                      "b.csv:2: got 8 numbers in R, expected 9");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, "100 ", "100 inf ")),
                      "got 4 numbers in t, expected 3");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, "100 ", "inf ")),
                      "got t = \"inf\", expected a finite number");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, "-1\n", "\n")), "got time = \"\"");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, "0 -1 0", "0 -2 0")),
                      "b.csv:2: rotation matrix is not orthonormal");
  EXPECT_INVALID_WITH(parse_detections(with(kBopRow, "0 -1 0", "0 1 0")),
                      "b.csv:2: rotation matrix has determinant -1");
  EXPECT_INVALID_WITH(parse_detections(kBopRow + kBopHeader),
                      "b.csv:2: got scene_id = \"scene_id\"");
  EXPECT_INVALID_WITH(parse_detections(std::string("\0\1", 2)), "NUL");
  EXPECT_INVALID_WITH(read_bop("/nowhere/b.csv", {1, 1}), "/nowhere/b.csv: cannot be read");
}

TEST(BopData, ResultFiles) {
  POSEMIX_REQUIRE_DATA();
  const auto folder = *testing::data_dir() / "bop_toolkit";
  const auto count = [&](const char* file, BopSelection selection) {
    std::size_t rows = 0;
    for (const auto& [image, poses] : read_bop(folder / file, selection)) rows += poses.size();
    return rows;
  };
  EXPECT_EQ(count("gt-pbrreal-rgb-mmodel_tless-test_tless.even_scenes.csv", {20, 1}), 343U);
  EXPECT_EQ(
      count("cnos-fastsammegapose_tless-test_94e046a0-42af-495f-8a35-11ce8ee6f217.even_scenes.csv",
            {20, 2}),
      336U);
  const auto mug = read_bop(
      folder /
          "cnos-fastsammegapose_ycbv-test_8fe0af14-16e3-431a-83e7-df00e93828a6.even_scenes.csv",
      {48, 14});
  EXPECT_NEAR(mug.at(2066)[0].pose.translation().z(), 0.8472963256835938, 1e-15);
}

}  // namespace
}  // namespace posemix
