// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The published offline numbers and the summary of `study ycbv`.
#include <cmath>

#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "posemix/base/units.hpp"
#include "recording_tree.hpp"
#include "study/ycbv/anees.hpp"
#include "study/ycbv/paired.hpp"
#include "study/ycbv/study.hpp"

namespace posemix {
namespace {

using testing::RecordingTree;
using Json = nlohmann::json;

const std::string kBox(testing::kTreeBox);
const std::string kTable = "derived/slam6d_published_table1.csv";

/// Two recordings of the box. The published errors of the first are larger than any filter's, those
/// of the second smaller. The second starts with a detection that is half a turn off.
struct PublishedTree : RecordingTree {
  PublishedTree() {
    put_dope("0001");
    put_dope("0002");
    put(kTable, "object,seq,Cauchy,ACT,%Detected\n" + kBox + ",0001,2000,1000,99%\n" + kBox +
                    ",0002,0.003,0.001,98%\n");
    auto detections = read_tum(path() / kInitial, {.allow_misses = true});
    detections[0].pose = *detections[0].pose * SE3d(SO3d::exp({0.0, 0.0, 3.1}), {0, 0, 0});
    put(kInitial, format_tum(detections, TumMisses::write_zeros));
    for (const char* sequence : {"0001", "0002"}) turn_odometry(sequence);
  }

  /// Lets the odometry's rotation drift by 0.1 degrees a frame.
  void turn_odometry(const std::string& sequence) {
    const std::string file = "slam-super-6d/experiments/ycbv/odom/results/" + sequence + ".txt";
    auto odometry = read_tum(path() / file);
    for (StampedPose& frame : odometry)
      frame.pose = *frame.pose * SE3d(SO3d::exp({0.0, radians(frame.stamp), 0.0}), {0, 0, 0});
    put(file, format_tum(odometry));
  }

  const std::string kInitial =
      "slam-super-6d/experiments/ycbv/inference/" + kBox + "/Initial/0002.txt";
};

Json study_of(const YcbvStudySettings& settings) {
  const Study study = make_ycbv_study(settings);
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  return Json::parse(study.report(results).files.at(0).content);
}

Json find(const Json& rows, const std::string& method, const std::string& sequence = "") {
  for (const Json& row : rows) {
    if (row["method"] == method && (sequence.empty() || row["sequence"] == sequence)) return row;
  }
  ADD_FAILURE() << "no row " << method << " " << sequence;
  return Json::object();
}

TEST(YcbvSummary, PublishedNumbersAreRowsOfTheirOwn) {
  const PublishedTree tree;
  const Json study = study_of({.data = tree.path(), .methods = {"published_offline"}});
  const Json act = find(study["rows"], "published: ACT", "0001");
  EXPECT_EQ(act["pixel_median"], 1000.0);
  EXPECT_TRUE(act["relative_rotation_rmse_deg"].is_null());
  EXPECT_TRUE(act["camera_rotation_rmse_deg"].is_null());
  EXPECT_EQ(find(study["rows"], "published: Cauchy", "0002")["pixel_median"], 0.003);
  EXPECT_EQ(find(study["rows"], "published: ACT", "median")["pixel_median"], 500.0005);
  for (const Json& row : study["rows"])
    EXPECT_EQ(row["method"].get<std::string>().find('%'), std::string::npos);
}

TEST(YcbvSummary, ComparesWithThePublishedNumbersAndTheOdometry) {
  const PublishedTree tree;
  const std::vector<std::string> filters{"riekf", "riekf_cauchy", "max_mixture", "rbpf", "default"};
  std::vector<std::string> methods{"published_offline", "odometry"};
  methods.insert(methods.end(), filters.begin(), filters.end());
  const Json study = study_of({.data = tree.path(), .methods = methods});
  const Json& rows = study["rows"];
  for (const std::string& method : filters) {
    SCOPED_TRACE(method);
    const Json summary = find(study["summary"], method);
    EXPECT_EQ(summary["rows"], 2);
    EXPECT_EQ(summary["better_than_act"], 1);
    EXPECT_EQ(summary["better_than_act_last_map"], 1);
    EXPECT_EQ(summary["compared_with_act"], 2);
    for (const auto& [ratio, column] :
         {std::pair("camera_rotation_over_odometry", "camera_rotation_rmse_deg"),
          std::pair("camera_position_over_odometry", "camera_position_rmse_cm")}) {
      double product = 1.0;
      for (const char* sequence : {"0001", "0002"})
        product *= find(rows, method, sequence)[column].get<double>() /
                   find(rows, "odometry", sequence)[column].get<double>();
      EXPECT_NEAR(summary[ratio].get<double>(), std::sqrt(product), 1e-9 * std::sqrt(product));
    }
    EXPECT_EQ(summary["first_detection_wrong"], 1);
    EXPECT_EQ(find(rows, method, "0001")["first_detection_wrong"], 0);
    EXPECT_EQ(find(rows, method, "0002")["first_detection_wrong"], 1);
    EXPECT_EQ(find(rows, method, "0001")["ends_on_right_mode"], 1);
    EXPECT_EQ(summary["recovered"], find(rows, method, "0002")["ends_on_right_mode"]);
  }
  const Json act = find(study["summary"], "published: ACT");
  EXPECT_EQ(act["better_than_act"], 0);
  EXPECT_TRUE(act["better_than_act_last_map"].is_null());
  EXPECT_TRUE(act["recovered"].is_null());
  EXPECT_TRUE(find(study["summary"], "odometry")["pixel_median"].is_null());
  EXPECT_DOUBLE_EQ(find(study["summary"], "odometry")["camera_position_over_odometry"], 1.0);
}

TEST(YcbvSummary, ConsistencyIsMoreThanAMedian) {
  StudyTable rows({"detector", "method", "relative_anees", "right_mode_anees", "camera_anees",
                   "camera_rotation_anees", "camera_position_anees", "world_anees"});
  for (const double anees : {0.4, 0.9, 1.8, 96.9})
    rows.add({"dope", "default", anees, 1.0, Cell(), Cell(), Cell(), 0.1 * anees});
  rows.add({"dope", "detector", Cell(), Cell(), Cell(), Cell(), Cell(), Cell()});
  const StudyTable anees = summarise_anees(rows);
  ASSERT_EQ(anees.rows().size(), 3U);
  const std::vector<Cell> expected{"dope", "default", "relative", std::int64_t{4},
                                   1.35,   25.0,      96.9,       0.5};
  EXPECT_EQ(anees.rows()[0], expected);
  EXPECT_EQ(anees.rows()[1][2], Cell("relative, right mode"));
  EXPECT_EQ(anees.rows()[1][7], Cell(1.0));
  EXPECT_EQ(anees.rows()[2][2], Cell("world"));
}

TEST(YcbvSummary, EstimatesStandBesideDetections) {
  StudyTable rows({"detector", "method", "paired_rotation_deg", "paired_position_cm",
                   "paired_detection_rotation_deg", "paired_detection_position_cm"});
  rows.add({"dope", "default", 1.0, 2.0, 2.0, 1.0});
  rows.add({"dope", "default", 3.0, 2.0, 3.0, 4.0});
  rows.add({"dope", "default", 2.0, Cell(), 4.0, 5.0});
  rows.add({"dope", "detector", Cell(), Cell(), Cell(), Cell()});
  const StudyTable paired = summarise_paired(rows);
  ASSERT_EQ(paired.rows().size(), 2U);
  const std::vector<Cell> rotation{"dope", "default", "rotation [deg]", std::int64_t{3}, 2.0,
                                   3.0,    1.0,       std::int64_t{3}};
  EXPECT_EQ(paired.rows()[0], rotation);
  const std::vector<Cell> position{"dope", "default", "position [cm]", std::int64_t{2}, 2.0,
                                   2.5,    2.0,       std::int64_t{1}};
  EXPECT_EQ(paired.rows()[1], position);
}

TEST(YcbvSummary, SaysNothingWhereThereIsNothingToCompareWith) {
  RecordingTree tree;
  tree.put_dope("0001");
  const Json study = study_of({.data = tree.path(), .methods = {"max_mixture"}});
  const Json summary = find(study["summary"], "max_mixture");
  EXPECT_TRUE(summary["better_than_act"].is_null());
  EXPECT_TRUE(summary["compared_with_act"].is_null());
  EXPECT_TRUE(summary["camera_rotation_over_odometry"].is_null());
  EXPECT_TRUE(summary["pixel_median_last_map"].is_number());
}

TEST(YcbvSummary, ADamagedTableIsNamed) {
  PublishedTree tree;
  const auto make = [&] {
    return make_ycbv_study({.data = tree.path(), .methods = {"published_offline"}});
  };
  tree.put(kTable, "object,seq,ACT\n" + kBox + ",0001\n");
  EXPECT_INVALID_WITH(make(), "slam6d_published_table1.csv:2: got 2 fields, expected 3");
  tree.put(kTable, "object,seq,ACT\n" + kBox + ",0001,many\n");
  EXPECT_INVALID_WITH(make(), "slam6d_published_table1.csv:2: got");
  tree.put(kTable, "pairs,seq,ACT\n");
  EXPECT_INVALID_WITH(make(), "expected columns object, seq and those of the methods");
}

}  // namespace
}  // namespace posemix
