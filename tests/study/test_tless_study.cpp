// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/tless/study.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <numbers>

#include "posemix/base/units.hpp"
#include "posemix/testing/data.hpp"
#include "posemix/testing/expect.hpp"
#include "study/engine/run_study.hpp"
#include "study/tless/metric.hpp"
#include "study/tless/report.hpp"
#include "study/tless/run.hpp"

namespace posemix {
namespace {

using OrderedJson = nlohmann::ordered_json;

SE3d turned(double z_deg, double x = 0.0) {
  return SE3d(SO3d::exp({0.0, 0.0, radians(z_deg)}), {x, 0.0, 0.7});
}

/// A scene of two objects of class 5, detected by a camera at rest with a half turn in every second
/// image, and with one false detection.
TlessScene scene() {
  TlessScene scene;
  scene.scene = 7;
  for (int k = 0; k < 12; ++k) {
    scene.images.push_back(10 * k);
    scene.sequence.stamps.push_back(1.0 * k);
    scene.sequence.camera_truth.push_back(SE3d());
    const double flip = k % 2 == 0 ? 0.0 : 180.0;
    scene.candidates.push_back(
        {{"5", turned(flip, 0.0), 0.9}, {"5", turned(180.0 - flip, 0.2), 0.8}});
    if (k == 6) scene.candidates.back().push_back({"5", turned(0.0, -0.2), 0.6});
  }
  for (int i = 0; i < 2; ++i) {
    ObjectRecording object;
    object.id = "5." + std::to_string(i);
    object.detections.resize(12);
    object.relative_truth.assign(12, turned(0.0, 0.2 * i));
    object.world_truth = object.relative_truth;
    scene.sequence.objects.push_back(object);
    scene.classes.emplace_back("5");
  }
  return scene;
}

TlessStudySettings settings() {
  TlessStudySettings s;
  s.symmetries = tless_symmetries();  // object 5: half a turn about z
  return s;
}

TEST(TlessStudy, MeasuresTheNearestEquivalent) {
  const TlessStudySettings s = settings();
  const TlessMetric metric(s);
  const TlessErrors errors = metric.errors("5", turned(170.0, 0.01), turned(0.0));
  EXPECT_NEAR(errors.rotation_deg, 10.0, 1e-9);
  EXPECT_NEAR(errors.translation_m, 0.01, 1e-12);
  // A corner of the cube: a turn by 170 - 180 deg about z and 1 cm along x, the worst of four.
  double worst = 0.0;
  for (const double x : {-0.05, 0.05}) {
    for (const double y : {-0.05, 0.05}) {
      const double angle = radians(-10.0);
      const double dx = std::cos(angle) * x - std::sin(angle) * y + 0.01 - x;
      const double dy = std::sin(angle) * x + std::cos(angle) * y - y;
      worst = std::max(worst, std::hypot(dx, dy));
    }
  }
  EXPECT_NEAR(errors.mssd_m, worst, 1e-9);
  EXPECT_TRUE(errors.is_within);
  EXPECT_FALSE(metric.errors("5", turned(90.0), turned(0.0)).is_within);
  EXPECT_FALSE(metric.errors("6", turned(170.0), turned(0.0)).is_within);

  const std::vector<SE3d> poses{turned(0.0, 0.04), turned(90.0, 0.01), turned(0.0, 0.2)};
  EXPECT_NEAR(metric.nearest("5", poses, turned(0.0))->rotation_deg, 90.0, 1e-9);
  EXPECT_FALSE(metric.nearest("5", poses, turned(0.0, 0.12)).has_value());
}

TEST(TlessStudy, OdometryIsTheTruthWithNoiseOfTheStatedSize) {
  TlessScene long_scene = scene();
  long_scene.sequence.stamps.clear();
  long_scene.sequence.camera_truth.clear();
  constexpr int kFrames = 2001;
  for (int k = 0; k < kFrames; ++k) {
    long_scene.sequence.stamps.push_back(4.0 * k);
    long_scene.sequence.camera_truth.push_back(turned(3.0 * k, 0.01 * k));
  }
  TlessStudySettings s = settings();
  s.odometry_rotation_sd_deg = 0.5;
  s.odometry_translation_sd_m = 0.003;
  const Sequence noisy = with_synthetic_odometry(long_scene, s);
  EXPECT_TRUE(noisy.odometry[0]->is_approx(*noisy.camera_truth[0], 1e-12));
  Vector6d squares = Vector6d::Zero();
  for (std::size_t k = 1; k < kFrames; ++k) {
    const SE3d truth = noisy.camera_truth[k - 1]->inverse() * *noisy.camera_truth[k];
    const SE3d odometry = noisy.odometry[k - 1]->inverse() * *noisy.odometry[k];
    squares += (truth.inverse() * odometry).log().cwiseAbs2();
  }
  // Two standard deviations' worth of seconds per step; 2000 steps leave 1.6 % of the deviation.
  const Vector6d sd = (squares / (kFrames - 1)).cwiseSqrt();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(degrees(sd[i]), 1.0, 0.07);
    EXPECT_NEAR(sd[3 + i], 0.006, 0.0004);
  }
}

TEST(TlessStudy, SymmetriesEndTheFlips) {
  const OrderedJson declared = run_tless(scene(), settings(), true);
  const OrderedJson none = run_tless(scene(), settings(), false);
  EXPECT_EQ(declared["scene"]["models"], 4);  // three in one image, and one
  EXPECT_EQ(declared["scene"]["flips"], 0);
  EXPECT_EQ(declared["scene"]["confirmed"], 2);
  EXPECT_EQ(declared["scene"]["false_confirmed"], 0);
  EXPECT_EQ(declared["scene"]["detections"], 25);
  ASSERT_EQ(declared["instances"].size(), 2U);
  for (const OrderedJson& row : declared["instances"]) {
    EXPECT_EQ(row["frames"], 12);
    EXPECT_EQ(row["found"], 12);
    EXPECT_EQ(row["within"], 12);
    EXPECT_EQ(row["detection_within"], 12);
    EXPECT_EQ(row["end_within"], 1);
    EXPECT_LT(row["rotation_deg"], 1.0);
  }
  EXPECT_EQ(none["scene"]["symmetries"], "none");
  EXPECT_EQ(none["scene"]["detections"], 25);

  const std::vector<std::string> results{declared.dump(), none.dump()};
  const StudyReport report = report_tless(results);
  ASSERT_EQ(report.files.size(), 5U);
  EXPECT_EQ(report.files[0].name, "study.json");
  EXPECT_EQ(report.files[4].name, "errors.svg");
  EXPECT_NE(report.files[4].content.find("estimate, symmetries declared"), std::string::npos);
  const OrderedJson study = OrderedJson::parse(report.files[0].content);
  EXPECT_EQ(study["rows"].size(), 4U);
  EXPECT_EQ(study["rows"][0]["object"], "5.0");
  EXPECT_EQ(study["summary"][0]["figure"], "scenes");
  const auto row_of = [&](const std::string& figure) -> OrderedJson {
    for (const OrderedJson& row : study["summary"]) {
      if (row["figure"] == figure) return row;
    }
    return nullptr;
  };
  EXPECT_EQ(row_of("estimate: share found")["declared"], 1.0);
  EXPECT_EQ(row_of("views of instances")["declared"], 24);
  EXPECT_EQ(row_of("estimate at the end: median position error")["unit"], "mm");
  EXPECT_EQ(report.summary.find("mssd_m"), std::string::npos) << "no keys of files";
  ASSERT_EQ(report.notes.size(), 2U);
  EXPECT_EQ(study["notes"][0], report.notes[0]);
  EXPECT_NE(report.notes[0].find("Within 20 deg and 5 cm are 100 % of the views"),
            std::string::npos)
      << report.notes[0];
}

TEST(TlessStudy, ReadsItsSettings) {
  const auto read = [](const std::string& text) {
    const TomlDocument document = TomlDocument::parse(text, "tless.toml");
    TlessStudySettings s = read_tless_settings(document.root());
    document.finish();
    return s;
  };
  const TlessStudySettings s = read("scenes = [2, 4]\nodometry = {rotation_sd_deg = 1.5}\n");
  EXPECT_EQ(s.scenes, (std::vector<std::int64_t>{2, 4}));
  EXPECT_EQ(s.odometry_rotation_sd_deg, 1.5);
  EXPECT_EQ(s.symmetries.at(5).elements().size(), 2U);
  EXPECT_NE(testing::thrown_message([&] { read("scenes = [2.5]\n"); }).find("scenes"),
            std::string::npos);
  EXPECT_NE(testing::thrown_message([&] { read("scene = [2]\n"); }).find("scene"),
            std::string::npos);
}

// On the data the filter is near the truth more often than single images, and flips without the
// symmetries but not with them.
TEST(TlessStudy, RecordedScenes) {
  POSEMIX_REQUIRE_DATA();
  if (!std::filesystem::is_directory(*testing::data_dir() / "bop_toolkit")) GTEST_SKIP();
  TlessStudySettings s = settings();
  s.data = *testing::data_dir();
  s.scenes = {2, 10};
  const Study study = make_tless_study(s);
  ASSERT_EQ(study.items, 4U);
  std::int64_t flips[2] = {0, 0};
  std::int64_t within = 0, detected = 0;
  for (std::size_t i = 0; i < study.items; ++i) {
    const std::string text = study.run_item(i);
    EXPECT_EQ(text, study.run_item(i));
    const OrderedJson result = OrderedJson::parse(text);
    flips[i % 2] += result["scene"]["flips"].get<std::int64_t>();
    if (i % 2 == 1) continue;
    for (const OrderedJson& row : result["instances"]) {
      within += row["within"].get<std::int64_t>();
      detected += row["detection_within"].get<std::int64_t>();
    }
  }
  EXPECT_GT(within, detected);
  EXPECT_EQ(flips[0], 0);
  EXPECT_GT(flips[1], 0);
  s.scenes = {1};
  EXPECT_NE(testing::thrown_message([&] { make_tless_study(s); }).find("scene 1"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix
