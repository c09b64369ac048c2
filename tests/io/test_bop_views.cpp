// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/bop_views.hpp"

#include <gtest/gtest.h>

#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::thrown_message;

BopRow row_of(std::int64_t object, double score, double x) {
  return {2, 5, object, score, SE3d(SO3d::exp({0.1, 0.2, x}), {x, 0.0, 0.7})};
}

TEST(BopViews, RowsAtOnePlaceAreOneObservation) {
  const std::vector<BopRow> rows{row_of(7, 0.2, 0.01), row_of(4, 0.9, 0.0), row_of(7, 0.6, 0.0),
                                 row_of(7, 0.5, 0.3)};
  const auto mixtures = bop_observations(rows);
  ASSERT_EQ(mixtures.size(), 3U);
  EXPECT_EQ(mixtures[0].class_id, "4");
  EXPECT_EQ(mixtures[1].class_id, "7");
  ASSERT_EQ(mixtures[1].components.size(), 2U);
  EXPECT_NEAR(mixtures[1].components[0].weight, 0.75, 1e-12);
  EXPECT_EQ(mixtures[1].components[0].pose.translation().x(), 0.0);
  EXPECT_EQ(mixtures[1].score, 0.6);
  EXPECT_EQ(mixtures[2].components[0].weight, 1.0);
  for (const Observation& observation : mixtures) validate(observation);
  EXPECT_EQ(bop_observations(rows, {.use = BopRowUse::rows}).size(), 4U);
  const auto best = bop_observations(rows, {.use = BopRowUse::best});
  ASSERT_EQ(best.size(), 2U);
  EXPECT_EQ(best[1].score, 0.6);
  EXPECT_EQ(bop_observations(rows, {.least_score = 0.55}).size(), 2U);
  const std::vector<BopRow> unscored{row_of(7, -1.0, 0.0), row_of(7, -1.0, 0.01)};
  EXPECT_EQ(bop_observations(unscored)[0].components[1].weight, 0.5);
  const std::vector<BopRow> zeros{row_of(7, 0.0, 0.0), row_of(7, 0.0, 0.01)};
  EXPECT_EQ(bop_observations(zeros)[0].components[1].weight, 0.5);
  // A score of zero beside others is a weight of zero.
  const std::vector<BopRow> one{row_of(7, 0.0, 0.0), row_of(7, 0.5, 0.01)};
  ASSERT_EQ(bop_observations(one)[0].components.size(), 1U);
  EXPECT_EQ(bop_observations(one)[0].components[0].weight, 1.0);
}

TEST(BopViews, TextsOfRowsAreReadBack) {
  const std::vector<BopRow> rows{row_of(7, 0.25, 0.01), row_of(4, 1.0, -0.2)};
  const auto read = parse_bop_rows(format_bop_rows(rows), "fused.csv");
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].object, rows[i].object);
    EXPECT_EQ(read[i].score, rows[i].score);
    EXPECT_TRUE(read[i].pose.is_approx(rows[i].pose, 1e-12));
  }
}

TEST(BopViews, ReadsTargetsOfSeveralViews) {
  const auto groups = parse_image_groups(
      R"([{"scene_id": 1, "im_id": [["default", 30], ["default", 2]]}, {"scene_id": 2, "im_id": [4, 5], "x": 0}])",
      "targets.json");
  EXPECT_EQ(groups, (std::vector<ImageGroup>{{1, {30, 2}}, {2, {4, 5}}}));
  const auto message = [](const std::string& text) {
    return thrown_message([&] { parse_image_groups(text, "targets.json"); });
  };
  EXPECT_NE(message("[").find("targets.json: got a text that is not JSON"), std::string::npos);
  EXPECT_NE(message("[]").find("got no group"), std::string::npos);
  EXPECT_NE(message(R"([{"scene_id": 1}])").find("im_id"), std::string::npos);
  EXPECT_NE(message(R"([{"scene_id": 1, "im_id": []}])").find("got no image"), std::string::npos);
  EXPECT_NE(message(R"([{"scene_id": 1, "im_id": [3, 4, 3]}])").find("im_id[2]: got image 3 again"),
            std::string::npos)
      << message(R"([{"scene_id": 1, "im_id": [3, 4, 3]}])");
  EXPECT_NE(message(R"([{"scene_id": 1, "im_id": [1.5]}])").find("1.5"), std::string::npos);
}

TEST(BopViews, ReadsCamerasOfScenes) {
  const std::string head = "scene_id,im_id,tx,ty,tz,qx,qy,qz,qw\n";
  const SceneCameras cameras =
      parse_scene_cameras("# T_world_camera\n" + head + "2,5,1,2,3,0,0,1,0\n", "cameras.csv");
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras.at({2, 5}).translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
  const auto message = [&](const std::string& rows) {
    return thrown_message([&] { parse_scene_cameras(head + rows, "cameras.csv"); });
  };
  EXPECT_EQ(message("2,5,1,2,3,0,0,1,0\n2,5,1,2,3,0,0,1,0\n"),
            "cameras.csv:3: got image 5 of scene 2 again, expected every image once");
  EXPECT_NE(message("2,5,1,2,3,0,0,1\n").find("cameras.csv:2: got 8 columns"), std::string::npos);
  EXPECT_NE(message("2,5,1,2,x,0,0,1,0\n").find("cameras.csv:2: got"), std::string::npos);
  EXPECT_NE(message("2,5,1,2,3,0,0,1,1\n").find("a quaternion of norm"), std::string::npos);
  EXPECT_NE(message("").find("got no row"), std::string::npos);
  EXPECT_NE(thrown_message([] { parse_scene_cameras("1,2\n", "c.csv"); }).find("head line"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix
