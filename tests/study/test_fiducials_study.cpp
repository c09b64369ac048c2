// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/fiducials/study.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/temporary_folder.hpp"
#include "posemix/testing/data.hpp"
#include "posemix/testing/expect.hpp"
#include "study/fiducials/recording.hpp"
#include "study/fiducials/run.hpp"
#include "tag_files.hpp"

namespace posemix {
namespace {

using OrderedJson = nlohmann::ordered_json;

using testing::kTagFrames;
using testing::position_text;
using testing::tag_pose;
using testing::tags_text;
using testing::write_recording;

OrderedJson run_one(const FiducialsStudySettings& settings) {
  const Study study = make_fiducials_study(settings);
  return OrderedJson::parse(study.run_item(0));
}

#ifdef POSEMIX_WITH_YAML

TEST(FiducialsStudy, ScoresARecordingWithOdometry) {
  const testing::TemporaryFolder data;
  write_recording(data, "with_odometry", true, 0);
  const OrderedJson found = run_one({.data = data.path()});
  const OrderedJson& row = found["row"];
  EXPECT_EQ(row["recording"], "with_odometry");
  EXPECT_EQ(row["input"], "weights");
  EXPECT_EQ(row["priors"], false);
  EXPECT_EQ(row["frames"], kTagFrames);
  EXPECT_EQ(row["sightings"], 5 * kTagFrames);
  EXPECT_EQ(row["scored_frames"], kTagFrames);
  EXPECT_EQ(row["tags"], 5);
  EXPECT_EQ(row["tags_from_several_sides"], 5);
  EXPECT_EQ(row["wrong_at_end"], 0);
  EXPECT_LT(row["wrong_share"], 0.05);
  EXPECT_LT(row["camera_rms_m"], 0.03);
  EXPECT_GT(row["odometry_rms_m"], 0.005);
  EXPECT_TRUE(row["survey_frame_rms_m"].is_null());
  EXPECT_TRUE(row["normal_median_deg"].is_null());
  EXPECT_TRUE(row["camera_anees"].is_null());
  EXPECT_EQ(found["tags"].size(), 5U);
  EXPECT_EQ(found["timing"]["frames"], kTagFrames);
  EXPECT_NEAR(found["timing"]["recorded_s"].get<double>(), (kTagFrames - 1) / 20.0, 1e-9);
  EXPECT_GE(found["timing"]["worst_ms"], found["timing"]["mean_ms"]);
}

TEST(FiducialsStudy, PiecesThatNothingJoinsHavePosesThatAreNumbers) {
  POSEMIX_REQUIRE_DATA();
  for (const char* mode_time : {"0.3", "1.0"}) {
    for (const char* hypotheses : {"4", "8"}) {
      const OrderedJson row =
          run_one({.data = *testing::data_dir(),
                   .recordings = {"test_9"},
                   .inputs = {FiducialInput::weights},
                   .priors = false,
                   .overrides = {std::string("noise.tag.mode_time_s=") + mode_time,
                                 std::string("filter.max_hypotheses=") + hypotheses}})["row"];
      EXPECT_EQ(row["frames_not_finite"], 0);
      // A tag that is seen from several sides is right in its own piece.
      EXPECT_LT(row["wrong_share"], 0.1);
    }
  }
}

TEST(FiducialsStudy, ASurveyGivesTheFrameOrTheTruth) {
  const testing::TemporaryFolder data;
  write_recording(data, "surveyed", false, 3);
  FiducialsStudySettings settings{.data = data.path()};
  const OrderedJson with = run_one(settings)["row"];
  EXPECT_EQ(with["priors"], true);
  EXPECT_LT(with["survey_frame_rms_m"], 0.05);
  EXPECT_EQ(with["surveyed_tags"], 3);
  EXPECT_LT(with["normal_max_deg"], 5.0);
  EXPECT_TRUE(with["camera_anees"].is_number());
  EXPECT_TRUE(with["tag_anees"].is_null());
  EXPECT_TRUE(with["odometry_rms_m"].is_null());
  settings.priors = false;
  const OrderedJson without = run_one(settings)["row"];
  EXPECT_EQ(without["priors"], false);
  EXPECT_TRUE(without["survey_frame_rms_m"].is_null());
  EXPECT_EQ(without["surveyed_tags"], 3);
  EXPECT_LT(without["normal_max_deg"], 5.0);
  EXPECT_TRUE(without["camera_anees"].is_null());
  EXPECT_TRUE(without["tag_anees"].is_number());
}

TEST(FiducialsStudy, ASurveyOfAnotherPlaceIsListed) {
  const testing::TemporaryFolder data;
  write_recording(data, "moved", true, 0);
  std::string text = tags_text(1);
  const std::string place = position_text(tag_pose(0).translation());
  text.replace(text.find(place), place.size(), "{x: 9, y: 0, z: 0}");
  data.put("tagslam/moved/tagslam.yaml", text);
  const OrderedJson found = run_one({.data = data.path(), .priors = false});
  EXPECT_EQ(found["row"]["survey_off"], 1);
  EXPECT_EQ(found["row"]["surveyed_tags"], 0);
  EXPECT_EQ(found["tags"][0]["survey_off"], 1);
  EXPECT_GT(found["tags"][0]["survey_position_m"], 9.0);
  EXPECT_TRUE(found["tags"][1]["survey_off"].is_null());
}

TEST(FiducialsStudy, ReportsEveryInputOfEveryRecording) {
  const testing::TemporaryFolder data;
  write_recording(data, "a", true, 0);
  write_recording(data, "b", true, 0);
  data.put("tagslam/LICENSE", "a file beside the recordings\n");
  const Study study = make_fiducials_study(
      {.data = data.path(), .inputs = {FiducialInput::weights, FiducialInput::best}});
  ASSERT_EQ(study.items, 4U);
  std::vector<std::string> results;
  for (std::size_t i = 0; i < study.items; ++i) results.push_back(study.run_item(i));
  const StudyReport report = study.report(results);
  ASSERT_EQ(report.files.size(), 5U);
  const OrderedJson json = OrderedJson::parse(report.files[0].content);
  ASSERT_EQ(json["rows"].size(), 4U);
  EXPECT_EQ(json["rows"][3]["recording"], "b");
  EXPECT_EQ(json["rows"][3]["input"], "best");
  // Times are in a file of their own.
  EXPECT_EQ(report.files[0].content.find("_ms"), std::string::npos);
  EXPECT_NE(report.files[3].content.find("times_real_time"), std::string::npos);
  EXPECT_NE(report.files[4].content.find("<svg"), std::string::npos);
}

TEST(FiducialsStudy, ASingleCameraIsTheRig) {
  const testing::TemporaryFolder data;
  write_recording(data, "a", false, 0);
  const auto recordings = find_fiducial_recordings(data.path() / "tagslam");
  ASSERT_EQ(recordings.size(), 1U);
  const FiducialFolder folder = read_fiducial_recording(recordings[0]);
  ASSERT_EQ(folder.cameras.size(), 1U);
  EXPECT_TRUE(folder.cameras[0].rig_camera->pose.is_approx(SE3d(), 1e-12));
  EXPECT_EQ(folder.fiducials.observations.size(), 5U * kTagFrames);
  EXPECT_TRUE(read_fiducial_reference(recordings[0]).at(0.05).has_value());
}

#endif

TEST(FiducialsStudy, ReplacesObservations) {
  Observation observation = observation_of(SE3d());
  observation.components = {{0.2, SE3d(), {}}, {0.8, SE3d(SO3d(), {1.0, 0.0, 0.0}), {}}};
  Sequence sequence;
  sequence.observations = {{observation}, {}};
  Sequence same = sequence, equal = sequence, best = sequence;
  replace_observations(FiducialInput::weights, same);
  EXPECT_EQ(same.observations[0][0].components[0].weight, 0.2);
  replace_observations(FiducialInput::equal, equal);
  ASSERT_EQ(equal.observations[0][0].components.size(), 2U);
  EXPECT_EQ(equal.observations[0][0].components[0].weight, 0.5);
  EXPECT_EQ(equal.observations[0][0].components[1].weight, 0.5);
  replace_observations(FiducialInput::best, best);
  ASSERT_EQ(best.observations[0][0].components.size(), 1U);
  EXPECT_EQ(best.observations[0][0].components[0].weight, 1.0);
  EXPECT_EQ(best.observations[0][0].components[0].pose.translation().x(), 1.0);
}

TEST(FiducialsStudy, ReadsItsSettings) {
  const auto read = [](const std::string& text) {
    const TomlDocument document = TomlDocument::parse(text, "fiducials.toml");
    FiducialsStudySettings settings = read_fiducials_settings(document.root());
    document.finish();
    return settings;
  };
  const FiducialsStudySettings s =
      read("recordings = ['test_9']\ninputs = ['best', 'equal']\npriors = false\nsize_m = 0.2\n");
  EXPECT_EQ(s.recordings, std::vector<std::string>{"test_9"});
  EXPECT_EQ(s.inputs, (std::vector<FiducialInput>{FiducialInput::best, FiducialInput::equal}));
  EXPECT_FALSE(s.priors);
  EXPECT_EQ(s.size_m, 0.2);
  EXPECT_EQ(s.folder, "tagslam");
  const std::string wrong = testing::thrown_message([&] { read("inputs = ['worst']\n"); });
  EXPECT_NE(wrong.find("worst"), std::string::npos);
  EXPECT_NE(wrong.find("weights, equal, best"), std::string::npos);
  EXPECT_FALSE(testing::thrown_message([&] { read("inputs = []\n"); }).empty());
}

TEST(FiducialsStudy, NamesWhatIsNotThere) {
  const testing::TemporaryFolder data;
  const auto message = [&](const FiducialsStudySettings& settings) {
    return testing::thrown_message([&] { make_fiducials_study(settings); });
  };
  EXPECT_NE(message({.data = data.path()}).find("tagslam"), std::string::npos);
  data.put("tagslam/a/corners.csv", "");
  EXPECT_NE(message({.data = data.path()}).find("no recording"), std::string::npos);
  data.put("tagslam/a/cameras.yaml", "");
  const std::string unknown = message({.data = data.path(), .recordings = {"b"}});
  EXPECT_NE(unknown.find("no recording b, expected one of a"), std::string::npos) << unknown;
}

}  // namespace
}  // namespace posemix
