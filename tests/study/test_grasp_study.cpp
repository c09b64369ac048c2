// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/grasp/study.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/temporary_folder.hpp"
#include "posemix/base/units.hpp"
#include "posemix/io/grasp_outcomes.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/testing/data.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using Json = nlohmann::json;
using testing::thrown_message;

/// Two estimators in three scenes: errors of 2 deg and 4 mm (25 mm of depth), one in ten ten times
/// as large. Object 1 is in the scenes named first, object 2 in the last only; grasps tolerate 12
/// mm across z for object 1, 9 mm for object 2. Object 3 is always grasped.
void put_tables(const testing::TemporaryFolder& folder, const std::string& below,
                std::uint64_t seed, std::int64_t first_scene, int frames) {
  for (const std::string estimator : {"one", "two"}) {
    RandomStream stream(seed, estimator == "one" ? 1 : 2);
    std::string text =
        "# simulated\nscene_id,im_id,obj_id,score,est_tx,est_ty,est_tz,est_qx,est_qy,est_qz,est_qw,"
        "gt_tx,gt_ty,gt_tz,gt_qx,gt_qy,gt_qz,gt_qw,grasp_claw\n";
    for (std::int64_t scene = first_scene; scene < first_scene + 3; ++scene) {
      for (int i = 0; i < frames; ++i) {
        for (const std::int64_t object : {1, 2, 3}) {
          if (object == 2 && scene != first_scene + 2) continue;
          Vector6d error;
          for (double& value : error) value = stream.normal();
          if (stream.uniform() < 0.1) error *= 10.0;
          error.head<3>() *= radians(2.0);
          error.tail<3>().array() *= Eigen::Array3d(4e-3, 4e-3, 25e-3);
          const SE3d truth(SO3d::exp({0.02 * i, 0.01 * i, 0.3 * static_cast<double>(object)}),
                           {0.1, 0.002 * i, 0.8});
          const SE3d estimate(SO3d::exp(error.head<3>()) * truth.rotation(),
                              truth.translation() + error.tail<3>());
          const Eigen::Vector3d offset = (truth.inverse() * estimate).translation();
          const bool success = object == 3 || std::abs(offset.z()) < (object == 1 ? 12e-3 : 9e-3);
          const auto numbers = [](const SE3d& pose) {
            std::string words = format_pose(pose);
            std::replace(words.begin(), words.end(), ' ', ',');
            return words;
          };
          text += std::to_string(scene) + "," + std::to_string(10 * i) + "," +
                  std::to_string(object) + ",0.5," + numbers(estimate) + "," + numbers(truth) +
                  (success ? ",1\n" : ",0\n");
        }
      }
    }
    folder.put(below + "/set_" + estimator + ".csv", text);
  }
}

GraspStudySettings quick() {
  GraspStudySettings settings;
  settings.errors.max_components = 2;
  settings.errors.restarts = 1;
  settings.consensus.draws_per_member = 60;
  settings.bootstrap_regions = 3;
  settings.region.starts = 1;
  settings.blocks = 3;
  return settings;
}

StudyReport run_all(const Study& study) {
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  return study.report(results);
}

std::string file(const StudyReport& report, const std::string& name) {
  for (const StudyFile& f : report.files) {
    if (f.name == name) return f.content;
  }
  return {};
}

/// The row of study.json with these values; null if there is none.
Json find_row(const StudyReport& report, const Json& wanted) {
  const Json study = Json::parse(report.files.front().content);
  for (const Json& row : study["rows"]) {
    bool fits = true;
    for (const auto& [key, value] : wanted.items()) fits = fits && row.at(key) == value;
    if (fits) return row;
  }
  return {};
}

Json pooled_row(const StudyReport& report, const std::string& method, const std::string& split) {
  return find_row(report, {{"method", method},
                           {"split", split},
                           {"object", "all"},
                           {"gripper", "all"},
                           {"estimator", "all"}});
}

TEST(GraspStudy, LeavesOutScenesAndBlocks) {
  const testing::TemporaryFolder folder;
  put_tables(folder, "data", 1, 7, 40);
  const Study study = make_grasp_study(read_grasp_outcomes(folder / "data"), std::nullopt, quick());
  EXPECT_EQ(study.name, "grasp");
  ASSERT_EQ(study.items, 6U);  // three scenes, three blocks
  EXPECT_EQ(study.run_item(4), study.run_item(4));
  const StudyReport report = run_all(study);
  EXPECT_EQ(report.files.front().name, "study.json");

  const Json region = pooled_row(report, "region_at_true_error", "scene");
  EXPECT_EQ(region["grasps"], 240);  // object 1: 3 scenes, 40 images, 2 estimators
  EXPECT_GT(region["accuracy"], 0.95);
  const Json mixture = pooled_row(report, "mixture", "scene");
  EXPECT_LT(mixture["brier"], pooled_row(report, "base_rate", "scene")["brier"].get<double>());
  EXPECT_GE(mixture["brier"], region["brier"].get<double>());
  EXPECT_EQ(pooled_row(report, "mixture", "block")["grasps"], 80);
  EXPECT_EQ(pooled_row(report, "mixture", "all")["grasps"], 320);

  const Json certain =
      find_row(report, {{"method", "mixture"}, {"object", "set/3"}, {"estimator", "one"}});
  EXPECT_EQ(certain["region"], "base_rate");
  EXPECT_EQ(certain["auc"], nullptr);
  EXPECT_LT(certain["brier"], 1e-3);
  EXPECT_EQ(find_row(report, {{"method", "mixture"}, {"object", "set/2"}})["region"], "own");

  const std::string predictions = file(report, "predictions.csv");
  EXPECT_EQ(std::count(predictions.begin(), predictions.end(), '\n'), 1 + 240 + 80 + 240);
  EXPECT_NE(file(report, "regions.csv").find("half_width_translation_z_mm"), std::string::npos);
  EXPECT_LT(file(report, "reliability.svg").find("<svg"), 200U);
}

TEST(GraspStudy, LearnsFromAnotherFolder) {
  const testing::TemporaryFolder folder;
  put_tables(folder, "data", 2, 7, 20);
  put_tables(folder, "train", 3, 20, 30);
  const GraspOutcomes data = read_grasp_outcomes(folder / "data");
  GraspOutcomes train = read_grasp_outcomes(folder / "train");
  std::erase_if(train.trials, [](const GraspTrial& t) { return t.object == 2; });
  const Study study = make_grasp_study(data, train, quick());
  ASSERT_EQ(study.items, 1U);
  const StudyReport report = run_all(study);
  const Json mixture = pooled_row(report, "mixture", "train");
  EXPECT_EQ(mixture["grasps"], 120 + 40);
  EXPECT_LT(mixture["brier"], pooled_row(report, "base_rate", "train")["brier"].get<double>());
  EXPECT_TRUE(pooled_row(report, "mixture", "all").is_null());
  const Json learnt =
      find_row(report, {{"method", "mixture"}, {"object", "learnt"}, {"gripper", "all"}});
  EXPECT_EQ(learnt["grasps"], 120);
  EXPECT_EQ(learnt["region"], "own");
  EXPECT_EQ(find_row(report, {{"method", "mixture"}, {"object", "set/2"}})["region"], "pooled");
  EXPECT_EQ(find_row(report, {{"method", "mixture"}, {"object", "set/1"}})["region"], "own");
}

TEST(GraspStudy, ReadsItsSettings) {
  const TomlDocument document = TomlDocument::parse(
      "draws = 10\ncorrelation = 0.2\n[[symmetry]]\ndataset = \"a\"\nobject = 4\naxis = [0, 2, 0]\n"
      "fold = 2\n[[symmetry]]\ndataset = \"a\"\nobject = 5\n",
      "g.toml");
  const GraspStudySettings settings = read_grasp_settings(document.root());
  document.finish();
  EXPECT_EQ(settings.consensus.draws_per_member, 10U);
  ASSERT_EQ(settings.symmetric.size(), 2U);
  const SymmetryGroup& half_turn = settings.symmetric[0].symmetry;
  ASSERT_EQ(half_turn.elements().size(), 2U);
  EXPECT_TRUE(half_turn.axes().empty());
  const SO3d about_y = SO3d::exp(std::numbers::pi * Eigen::Vector3d::UnitY());
  EXPECT_TRUE(half_turn.elements()[1].rotation().is_approx(about_y, 1e-12));
  EXPECT_TRUE(settings.symmetric[1].symmetry.is_trivial());
  const TomlDocument bad = TomlDocument::parse("correlation = 2", "g.toml");
  EXPECT_NE(thrown_message([&] { read_grasp_settings(bad.root()); }).find("g.toml:1"),
            std::string::npos);
  EXPECT_EQ(thrown_message([] { make_grasp_study({}, std::nullopt, {}); }),
            "study grasp: there are no outcomes of grasps to predict");
}

}  // namespace
}  // namespace posemix
