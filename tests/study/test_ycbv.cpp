// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/ycbv/study.hpp"

#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/results/report.hpp"
#include "recording_tree.hpp"

namespace posemix {
namespace {

using testing::RecordingTree;
using Json = nlohmann::json;

const std::string kBoxOfTree(testing::kTreeBox);
const std::string kExperiments = "slam-super-6d/experiments/ycbv/";

StudyReport report_of(const Study& study) {
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  return study.report(results);
}

std::string file_named(const StudyReport& report, const std::string& name) {
  for (const StudyFile& file_named : report.files) {
    if (file_named.name == name) return file_named.content;
  }
  return {};
}

Json rows_of(const StudyReport& report) {
  return Json::parse(file_named(report, "study.json")).at("rows");
}

Json run_rows(const YcbvStudySettings& settings) {
  return rows_of(report_of(make_ycbv_study(settings)));
}

Json find_sequence_row(const Json& rows, const std::string& sequence, const std::string& object,
                       const std::string& method) {
  for (const Json& row : rows) {
    if (row["sequence"] == sequence && row["object"] == object && row["method"] == method)
      return row;
  }
  ADD_FAILURE() << "no row " << sequence << " " << object << " " << method;
  return Json::object();
}

/// One recording of each detector.
struct SmallTree : RecordingTree {
  SmallTree() {
    put_dope("0001");
    put_cosypose("0022");
  }
};

TEST(YcbvStudy, HasOneRowPerSequenceObjectAndMethod) {
  const SmallTree tree;
  const Json rows = run_rows({.data = tree.path()});
  const std::size_t methods = ycbv_methods().size();
  // 0022 has two objects; "published" leaves DOPE out; mean and median by detector and method.
  // There is no table of published numbers for "published_offline".
  EXPECT_EQ(rows.size(), 2 * (methods - 1) + (methods - 2) + 2 * (methods - 1 + methods - 2));
  for (const std::string& method : ycbv_methods()) {
    if (method == "published_offline") continue;
    find_sequence_row(rows, "0022", "4", method);
    find_sequence_row(rows, "0022", "14", method);
    find_sequence_row(rows, "mean", "all", method);
    if (method != "published") find_sequence_row(rows, "0001", kBoxOfTree, method);
  }
}

TEST(YcbvStudy, KeptRunsAreLinkedFromTheirRows) {
  if (!has_report_page()) GTEST_SKIP() << "this build has no report page";
  const SmallTree tree;
  const testing::TemporaryFolder out;
  const YcbvStudySettings settings{
      .data = tree.path(),
      .methods = {"detector", "default", "varied: filter.max_hypotheses=5"},
      .sequences = {"0022"},
      .runs_in = out.path(),
      .command = {"posemix", "study", "ycbv"}};
  const Json rows = run_rows(settings);
  EXPECT_EQ(find_sequence_row(rows, "0022", "4", "default")["report"],
            "runs/0022-cosypose-all-default/report.html");
  EXPECT_TRUE(find_sequence_row(rows, "0022", "4", "detector")["report"].is_null());
  EXPECT_TRUE(find_sequence_row(rows, "mean", "all", "default")["report"].is_null());
  for (const char* method : {"default", "varied"}) {
    const std::filesystem::path page =
        out / find_sequence_row(rows, "0022", "14", method)["report"].get<std::string>();
    EXPECT_TRUE(std::filesystem::exists(page)) << page;
    const Json metrics = Json::parse(testing::content_of(page.parent_path() / "metrics.json"));
    EXPECT_EQ(metrics["provenance"]["command"], "posemix study ycbv");
    EXPECT_EQ(metrics["provenance"]["settings"]["method"], method);
  }
  const Json without =
      run_rows({.data = tree.path(), .methods = {"default"}, .sequences = {"0022"}});
  EXPECT_FALSE(find_sequence_row(without, "0022", "4", "default").contains("report"));
}

TEST(YcbvStudy, KeptRunsOfMethodsWithAlikeNamesAreApart) {
  if (!has_report_page()) GTEST_SKIP() << "this build has no report page";
  const SmallTree tree;
  const testing::TemporaryFolder out;
  const Json rows =
      run_rows({.data = tree.path(),
                .methods = {"a b: filter.max_hypotheses=2", "a+b: filter.max_hypotheses=3",
                            "default", "default: filter.max_hypotheses=4",
                            std::string(240, 'x') + ": filter.max_hypotheses=5"},
                .sequences = {"0022"},
                .runs_in = out.path()});
  std::set<std::string> pages;
  for (const Json& row : rows)
    if (row["report"].is_string()) pages.insert(row["report"].get<std::string>());
  EXPECT_EQ(pages.size(), 5U);
  for (const std::string& page : pages) EXPECT_TRUE(std::filesystem::exists(out / page)) << page;
}

TEST(YcbvStudy, RowsSayWhatIsKnown) {
  const SmallTree tree;
  const Json rows = run_rows({.data = tree.path()});
  const Json detector = find_sequence_row(rows, "0001", kBoxOfTree, "detector");
  EXPECT_EQ(detector["frames"], testing::kTreeFrames);
  EXPECT_EQ(detector["detections"], testing::kTreeFrames - 1);
  EXPECT_TRUE(detector["camera_rotation_rmse_deg"].is_null());
  EXPECT_NEAR(detector["relative_rotation_rmse_deg"], 1.0, 0.5);
  EXPECT_GT(detector["pixel_median"], 1.0);
  EXPECT_EQ(detector["object_truth"], "ground truth");
  const Json odometry = find_sequence_row(rows, "0001", kBoxOfTree, "odometry");
  EXPECT_TRUE(odometry["relative_rotation_rmse_deg"].is_null());
  EXPECT_TRUE(odometry["merges_per_frame"].is_null());
  const Json midway = find_sequence_row(rows, "0001", kBoxOfTree, "midway");
  for (const char* column :
       {"camera_rotation_rmse_deg", "camera_position_rmse_cm", "object_rotation_rmse_deg",
        "relative_position_rmse_cm", "relative_anees", "pixel_median", "merges_per_frame"})
    EXPECT_TRUE(midway[column].is_number()) << column;
  const Json mug = find_sequence_row(rows, "0022", "14", "midway");
  EXPECT_EQ(mug["object_truth"], "proxy");
  EXPECT_TRUE(mug["pixel_median"].is_null());
}

TEST(YcbvStudy, OdometryAloneDriftsAsMuchAsItWasMadeTo) {
  const SmallTree tree;
  const Json rows = run_rows({.data = tree.path(), .methods = {"odometry"}});
  double squared = 0.0;
  for (std::size_t k = 0; k < testing::kTreeFrames; ++k)
    squared += std::pow(0.1 * static_cast<double>(k), 2);
  const double drift = std::sqrt(squared / testing::kTreeFrames);
  // Here the odometry is stated for the annotated frame, and the true frame of the images is 2 cm
  // off.
  const double turn = 0.0207 * 100 * 0.01 * testing::kTreeFrames;
  for (const char* sequence : {"0001", "0022"}) {
    const Json row = find_sequence_row(
        rows, sequence, std::string(sequence) == "0001" ? kBoxOfTree : "4", "odometry");
    EXPECT_NEAR(row["camera_position_rmse_cm"], drift, turn);
    EXPECT_NEAR(row["camera_rotation_rmse_deg"], 0.0, 1e-6);
  }
}

TEST(YcbvStudy, MeansAndMediansAreOverTheRowsOfADetector) {
  SmallTree tree;
  tree.put_dope("0002");
  tree.put_dope("0003");
  tree.remove(kExperiments + "inference/" + kBoxOfTree + "/ground_truth/0003_ycb_gt.txt");
  tree.remove(kExperiments + "odom/ground_truth/0003.txt");
  const Json rows =
      run_rows({.data = tree.path(), .methods = {"detector"}, .objects = {kBoxOfTree}});
  ASSERT_EQ(rows.size(), 5U);
  const Json one = find_sequence_row(rows, "0001", kBoxOfTree, "detector");
  EXPECT_TRUE(find_sequence_row(rows, "0003", kBoxOfTree, "detector")["pixel_median"].is_null());
  EXPECT_TRUE(find_sequence_row(rows, "0003", kBoxOfTree, "detector")["object_truth"].is_null());
  for (const char* sequence : {"mean", "median"}) {
    const Json row = find_sequence_row(rows, sequence, "all", "detector");
    EXPECT_EQ(row["detector"], "dope");
    EXPECT_DOUBLE_EQ(row["pixel_median"], one["pixel_median"]);
    EXPECT_TRUE(row["camera_rotation_rmse_deg"].is_null());
  }
}

TEST(YcbvStudy, WithoutTruthAndOdometryTheFiltersStillRun) {
  RecordingTree tree;
  tree.put_dope("0001");
  tree.remove(kExperiments + "inference/" + kBoxOfTree + "/ground_truth/0001_ycb_gt.txt");
  tree.remove(kExperiments + "odom/ground_truth/0001.txt");
  tree.remove(kExperiments + "odom/results/0001.txt");
  tree.remove(kExperiments + "odom/YCB.yaml");
  const StudyReport report = report_of(make_ycbv_study({.data = tree.path()}));
  for (const Json& row : rows_of(report)) {
    if (row["sequence"] != "0001") continue;
    for (const char* column : {"camera_rotation_rmse_deg", "relative_rotation_rmse_deg",
                               "relative_anees", "pixel_median", "object_truth"})
      EXPECT_TRUE(row[column].is_null()) << column;
    EXPECT_EQ(row["detections"], testing::kTreeFrames - 1);
  }
  EXPECT_NE(file_named(report, "errors.svg").find("no ground truth"), std::string::npos);
}

TEST(YcbvStudy, OnlyTimesDifferFromRunToRun) {
  const SmallTree tree;
  const Study study = make_ycbv_study({.data = tree.path()});
  const StudyReport first = report_of(study);
  const StudyReport second = report_of(study);
  std::vector<std::string> names;
  for (const StudyFile& each : first.files) {
    names.push_back(each.name);
    if (each.name == "timing.csv") continue;
    EXPECT_EQ(each.content, file_named(second, each.name)) << each.name;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"study.json", "ycbv.csv", "summary.csv", "anees.csv",
                                             "paired.csv", "timing.csv", "reliability.csv",
                                             "reliability.svg", "errors.svg", "camera.svg"}));
  EXPECT_EQ(first.summary, second.summary);
  EXPECT_EQ(study.settings, make_ycbv_study({.data = tree.path()}).settings);
  EXPECT_EQ(study.settings.find('\n'), std::string::npos);
  EXPECT_EQ(study.run_item(0).find('\n'), std::string::npos);
}

TEST(YcbvStudy, TimesAreThoseOfTheFilters) {
  const SmallTree tree;
  const StudyReport report =
      report_of(make_ycbv_study({.data = tree.path(), .methods = {"detector", "midway"}}));
  const std::string timing = file_named(report, "timing.csv");
  EXPECT_TRUE(timing.starts_with("sequence,object,detector,method,frame_median_us,"));
  EXPECT_NE(timing.find("\n0022,all,cosypose,midway,"), std::string::npos);
  EXPECT_NE(timing.find("\nmean,all,dope,midway,"), std::string::npos);
  EXPECT_EQ(timing.find("detector,detector"), std::string::npos);
}

TEST(YcbvStudy, OverridesAndOwnMethodsReachTheFilter) {
  const SmallTree tree;
  const auto anees = [&](const YcbvStudySettings& settings, const std::string& method) {
    return find_sequence_row(run_rows(settings), "0001", kBoxOfTree, method)["relative_anees"]
        .get<double>();
  };
  const YcbvStudySettings plain{.data = tree.path(), .methods = {"default"}};
  YcbvStudySettings own = plain;
  own.methods = {"narrow: filter.camera_gain=0.9"};
  YcbvStudySettings all = plain;
  all.overrides = {"filter.camera_gain=0.9"};
  EXPECT_NE(anees(own, "narrow"), anees(plain, "default"));
  EXPECT_EQ(anees(own, "narrow"), anees(all, "default"));
  EXPECT_NE(make_ycbv_study(plain).settings, make_ycbv_study(all).settings);
}

TEST(YcbvStudy, ADamagedFileIsNamed) {
  SmallTree tree;
  tree.put(kExperiments + "odom/YCB.yaml", "Camera.fx: 1000.0\n");
  const Study study =
      make_ycbv_study({.data = tree.path(), .methods = {"detector"}, .objects = {kBoxOfTree}});
  EXPECT_INVALID_WITH(study.run_item(0), "YCB.yaml: got focal lengths 1000 and 0");
  tree.put(kExperiments + "_ycb_original.json", "{\"exported_objects\": [{}]}");
  EXPECT_INVALID_WITH(study.run_item(0), "_ycb_original.json: ");
  tree.put(kExperiments + "inference/" + kBoxOfTree + "/Initial/0001.txt", "0.0 x\n");
  EXPECT_INVALID_WITH(study.run_item(0), "Initial/0001.txt:1");
}

TEST(YcbvStudy, RefusesWhatIsNotThere) {
  const SmallTree tree;
  EXPECT_INVALID_WITH(
      make_ycbv_study({.data = tree.path(), .methods = {"kalman"}}),
      "method \"kalman\", expected one of detector, odometry, published_offline, riekf,");
  EXPECT_INVALID_WITH(make_ycbv_study({.data = tree.path(), .sequences = {"0099"}}),
                      "has no recording of sequence 0099 and object any");
  EXPECT_INVALID_WITH(
      make_ycbv_study({.data = tree.path(), .methods = {"published"}, .objects = {kBoxOfTree}}),
      "none of them is for the recordings");
}

TEST(YcbvSettings, AreReadFromATable) {
  const testing::TemporaryFolder folder;
  const auto profile = folder.put("own.toml", "schema = 1\n");
  const TomlDocument document = TomlDocument::parse(
      "methods = [\"midway\", \"own: filter.max_components=3\"]\nsequences = [\"0022\"]\n"
      "objects = [\"all\"]\nset = [\"filter.prune_below=1e-4\"]\n[profiles]\ndope = \"" +
          profile.string() + "\"\n",
      "study.toml");
  const YcbvStudySettings settings = read_ycbv_settings(document.root());
  document.finish();
  EXPECT_EQ(settings.methods, (std::vector<std::string>{"midway", "own: filter.max_components=3"}));
  EXPECT_EQ(settings.sequences, std::vector<std::string>{"0022"});
  EXPECT_EQ(settings.objects, std::vector<std::string>{"all"});
  EXPECT_EQ(settings.overrides, std::vector<std::string>{"filter.prune_below=1e-4"});
  EXPECT_EQ(settings.profiles.at("dope"), "schema = 1\n");
  const TomlDocument empty = TomlDocument::parse("x = 1\n", "study.toml");
  EXPECT_EQ(read_ycbv_settings(empty.root()).methods, ycbv_methods());
  const TomlDocument wrong = TomlDocument::parse("methods = [\"no\"]\n", "study.toml");
  EXPECT_INVALID_WITH(read_ycbv_settings(wrong.root()),
                      "study.toml:1: key 'methods' has method \"no\", expected one of");
}

}  // namespace
}  // namespace posemix
