// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <set>

#include "posemix/config/detector_noise.hpp"
#include "posemix/testing/data.hpp"
#include "posemix/testing/expect.hpp"
#include "study/fuse_views/report.hpp"
#include "study/fuse_views/run.hpp"
#include "study/fuse_views/scene.hpp"
#include "study/fuse_views/study.hpp"

namespace posemix {
namespace {

using OrderedJson = nlohmann::ordered_json;
using testing::thrown_message;

FuseViewsStudySettings read(const std::string& text) {
  const TomlDocument document = TomlDocument::parse(text, "fuse-views.toml");
  FuseViewsStudySettings s = read_fuse_views_settings(document.root());
  document.finish();
  return s;
}

/// Eight images around one object of class 5, of which one is missed and one is false.
MultiViewScene views_scene() {
  MultiViewScene views_scene;
  views_scene.dataset = "ycbv";
  views_scene.number = 3;
  const SE3d object(SO3d::exp({0.3, 0.0, 0.1}), Eigen::Vector3d::Zero());
  views_scene.world_objects[5] = {object};
  for (int k = 0; k < 8; ++k) {
    const SE3d turn(SO3d::exp({0.0, 0.7 * k, 0.0}), Eigen::Vector3d::Zero());
    const SE3d camera = turn * SE3d(SO3d(), {0.0, 0.0, -0.8});
    views_scene.images.push_back(k);
    views_scene.world_camera.push_back(camera);
    views_scene.truth.push_back({{3, k, 5, 1.0, camera.inverse() * object}});
    views_scene.estimates.push_back({});
    if (k != 2) views_scene.estimates.back().push_back(views_scene.truth.back()[0]);
  }
  views_scene.estimates[2].push_back({3, 2, 5, 0.5, SE3d(SO3d(), {0.4, 0.0, 0.8})});
  return views_scene;
}

TEST(FuseViewsStudy, GroupsHoldEveryImageOnce) {
  RandomStream stream(1);
  for (RandomStream* random : {static_cast<RandomStream*>(nullptr), &stream}) {
    const auto groups = image_groups(10, 4, random);
    ASSERT_EQ(groups.size(), 3U);
    EXPECT_EQ(groups[2].size(), 2U);
    std::set<std::size_t> all;
    for (const auto& group : groups) all.insert(group.begin(), group.end());
    EXPECT_EQ(all.size(), 10U);
  }
  EXPECT_EQ(image_groups(9, 4, nullptr).size(), 2U);  // an image alone is no group
}

TEST(FuseViewsStudy, CountsWhatIsFound) {
  const FuseViewsStudySettings settings = read("datasets = [\"ycbv\"]\n");
  const OrderedJson rows =
      run_fuse_views(views_scene(), settings, {default_detector_noise(), 0.8, 0.5});
  ASSERT_EQ(rows.size(), 18U);  // two groupings, three inputs, three noises, no symmetries
  for (const OrderedJson& row : rows) {
    EXPECT_EQ(row["pairs"], 8);
    EXPECT_EQ(row["single_found"], 7);
    EXPECT_EQ(row["fused_found"], 8);
    EXPECT_EQ(row["fused_within_10deg_2cm"], 8);
    EXPECT_EQ(row["instances"], 2);
    EXPECT_EQ(row["right_mode"], 2);
    EXPECT_EQ(row["rows"], 8);
    EXPECT_EQ(row["rows_false"], 1);
  }
  const std::vector<std::string> results{rows.dump()};
  const StudyReport report = report_fuse_views(results);
  ASSERT_EQ(report.files.size(), 4U);
  EXPECT_EQ(report.files[3].name, "noise-ycbv.toml");
  const TomlDocument noise = TomlDocument::parse(report.files[3].content, "noise.toml");
  EXPECT_EQ(
      read_detector_noise(noise.root().get_table("noise").get_table("detector")).clutter().weight,
      default_detector_noise().clutter().weight);
  EXPECT_EQ(report.files[0].name, "study.json");
  const OrderedJson study = OrderedJson::parse(report.files[0].content);
  EXPECT_EQ(study["rows"].size(), 18U);
  EXPECT_EQ(study["summary"][0]["single_found"], 0.875);
}

TEST(FuseViewsStudy, ReadsItsSettings) {
  const FuseViewsStudySettings s =
      read("views = 5\nscenes = [2]\n[fusion]\nmode_angle_deg = 10\nmax_components = 3\n");
  EXPECT_EQ(s.views, 5U);
  EXPECT_EQ(s.fusion.max_components, 3U);
  EXPECT_NEAR(s.fusion.mode_angle_rad, radians(10.0), 1e-12);
  EXPECT_FALSE(s.objects.at("tless").symmetries.empty());
  EXPECT_TRUE(s.objects.at("ycbv").symmetries.empty());
  EXPECT_NE(thrown_message([] { read("datasets = [\"lmo\"]\n"); }).find("lmo"), std::string::npos);
  EXPECT_NE(thrown_message([] { read("scenes = [2.5]\n"); }).find("scenes"), std::string::npos);
  EXPECT_NE(thrown_message([] { read("views = 1\n"); }).find("views"), std::string::npos);
  EXPECT_NE(thrown_message([] { read("[fusion]\nturned_share = 2\n"); }).find("turned_share"),
            std::string::npos);
}

// On the data fused poses are within the bounds more often than single ones; with the noise learned
// from other scenes, and errors correlated by the angle of view, their NEES is near one.
TEST(FuseViewsStudy, RecordedScenes) {
  POSEMIX_REQUIRE_DATA();
  if (!std::filesystem::is_directory(*testing::data_dir() / "bop_toolkit")) GTEST_SKIP();
  FuseViewsStudySettings s = read("datasets = [\"ycbv\"]\nscenes = [50, 54]\n");
  s.data = *testing::data_dir();
  const Study study = make_fuse_views_study(s);
  ASSERT_EQ(study.items, 2U);
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  EXPECT_EQ(results[0], study.run_item(0));
  const OrderedJson report = OrderedJson::parse(study.report(results).files[0].content);
  for (const OrderedJson& row : report["summary"]) {
    if (row["groups_of"] != "random" || row["noise"] != "learned") continue;
    EXPECT_GT(row["fused_within_10deg_2cm"].get<double>(),
              row["single_within_10deg_2cm"].get<double>() + 0.1)
        << row;
    // All scenes together: 1.1 to 1.3.
    EXPECT_GT(row["anees"].get<double>(), 0.4) << row;
    EXPECT_LT(row["anees"].get<double>(), 2.5) << row;
  }
  s.scenes = {1};
  EXPECT_NE(thrown_message([&] { make_fuse_views_study(s); }).find("no scene 1"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix
