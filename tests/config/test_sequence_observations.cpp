// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Sequence files with observations, cameras of a rig, and objects on sight.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include "io/expect_invalid.hpp"

#include "posemix/base/error.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/io/observation_jsonl.hpp"
#include "posemix/slam/job.hpp"
#include "small_recording.hpp"

namespace posemix {
namespace {

using testing::replaced;

constexpr const char* kTable =
    "stamp_s,camera,detector,id,class,sighting,weight,tx_m,ty_m,tz_m,qx,qy,qz,qw,"
    "c00,c01,c02,c03,c04,c05,c11,c12,c13,c14,c15,"
    "c22,c23,c24,c25,c33,c34,c35,c44,c45,c55\n"
    "0.00,left,,7,,0,0.6,0,0,1,0,0,0,1,,,,,,,,,,,,,,,,,,,,,\n"
    "0.00,left,,7,,0,0.4,0,0,1,0,0,1,0,,,,,,,,,,,,,,,,,,,,,\n"
    "0.05,left,,9,,1,1,0.2,0,1,0,0,0,1,,,,,,,,,,,,,,,,,,,,,\n"
    "0.10,left,,7,,2,1,0,0,1,0,0,0,1,,,,,,,,,,,,,,,,,,,,,\n";
constexpr const char* kOdometry =
    "0.0 0 0 0 0 0 0 1\n"
    "0.1 0.02 0 0 0 0 0 1\n";
constexpr const char* kSequence = R"(schema = 1
[camera]
odometry = "odometry.tum"
[[cameras]]
name = "left"
pose = [0.1, 0, 0, 0, 0, 0, 1]
[[observations]]
csv = "observations.csv"
[on_sight]
noise = "tag"
[noise.tag]
components = [{rotation_sd_deg = 1.0, translation_sd_m = 0.005}]
slow = "none"
clutter = {weight = 0.05, volume_m3 = 1.0}
)";

SlamJob job_of(const std::string& sequence, const std::string& table = kTable,
               const std::string& images = "0 left\n1e9 left\n") {
  const testing::TemporaryFolder folder;
  folder.put("observations.csv", table);
  folder.put("odometry.tum", kOdometry);
  folder.put("images.txt", images);
  return read_slam_job(TomlDocument::parse(sequence, "sequence.toml"), {folder.path()});
}

TEST(SequenceObservations, KnownObjectsAndACameraAnywhere) {
  const std::string known = std::string(kSequence) +
                            "[[objects]]\nid = \"7\"\nnoise = \"tag\"\n"
                            "prior = {pose = [1, 2, 3, 0, 0, 0, 1], rotation_sd_deg = 1.0, "
                            "translation_sd_m = [0.01, 0.02, 0.03], probability = 0.9}\n";
  const SlamJob job =
      job_of(replaced(known, "[camera]\n", "[camera]\nstart = {pose = \"unknown\"}\n"));
  const auto& prior = job.models.front().prior;
  ASSERT_TRUE(prior.has_value());
  EXPECT_EQ(prior->probability, 0.9);
  EXPECT_EQ(prior->world.mean().translation(), Eigen::Vector3d(1, 2, 3));
  // Perturbed on the left: along the object's axes it is as stated.
  const Matrix6d own = prior->world.mean().inverse().adjoint_congruence(prior->world.covariance());
  EXPECT_NEAR(own(4, 4), 4e-4, 1e-12);
  EXPECT_NEAR(std::sqrt(own(0, 0)), std::numbers::pi / 180.0, 1e-12);
  EXPECT_EQ(job.camera_prior.mean().translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(job.camera_prior.covariance()(0, 0), kUniformRotationVariance, 1e-9);
  EXPECT_INVALID_WITH(
      job_of(replaced(kSequence, "[camera]\n", "[camera]\nstart = {pose = \"unknown\"}\n")),
      "expected [[objects]] with a prior");
  EXPECT_INVALID_WITH(job_of(replaced(known, "probability = 0.9", "probability = 2")),
                      "probability");
}

TEST(SequenceObservations, LeavesNothingOutInSilence) {
  const std::string two = replaced(kTable, "0.05,left", "0.05,right");
  EXPECT_INVALID_WITH(
      job_of(
          replaced(kSequence, "[[cameras]]\nname = \"left\"\npose = [0.1, 0, 0, 0, 0, 0, 1]\n", ""),
          two),
      "observations.csv:4: got camera = \"right\", expected \"left\" as before, or a table "
      "[[cameras]]");
  EXPECT_INVALID_WITH(
      job_of(kSequence, replaced(kTable, "0.05,left,,9,,1", "0.05,left,,,mug,1")),
      "observations.csv:4: got class = \"mug\", expected that of one of the [[objects]], of "
      "which there are none");
  EXPECT_INVALID_WITH(
      job_of(replaced(kSequence, "[[observations]]\ncsv = \"observations.csv\"\n", "")),
      "is for observations, expected a table [[observations]] beside it");
}

TEST(SequenceObservations, AreOfSeveralDetectors) {
  const std::string two =
      replaced(std::string(kSequence), "noise = \"tag\"\n",
               "noise = \"tag\"\ndetectors = {near = \"tag\", far = \"wide\"}\n") +
      "[noise.wide]\ncomponents = [{rotation_sd_deg = 9.0, translation_sd_m = 0.1}]\n"
      "slow = \"none\"\nclutter = {weight = 0.05, volume_m3 = 1.0}\n";
  const std::string table = replaced(kTable, "0.05,left,,9", "0.05,left,far,9");
  const SlamJob job = job_of(two, table);
  ASSERT_EQ(job.models.front().detectors.size(), 2U);
  const auto sd = [&](const char* name) {
    return std::sqrt(job.models.front().detectors.at(name).components()[0].covariance(5, 5));
  };
  EXPECT_NEAR(sd("near"), 0.005, 1e-12);
  EXPECT_NEAR(sd("far"), 0.1, 1e-12);
  EXPECT_EQ(run(job).frames.size(), job.sequence.stamps.size());
  EXPECT_INVALID_WITH(job_of(replaced(two, "far = \"wide\"", "far = \"no\""), table),
                      "is \"no\", but there is no table [noise.no]");
  EXPECT_INVALID_WITH(run(job_of(two, replaced(kTable, "0.05,left,,9", "0.05,left,other,9"))),
                      "observations.csv:4: got detector = \"other\", expected one of the detectors "
                      "of \"9\", one of: far, near");
}

TEST(SequenceObservations, ImagesAreOfDetectorsThatTheObjectsHave) {
  const std::string two = replaced(
      replaced(std::string(kSequence), "noise = \"tag\"\n",
               "noise = \"tag\"\ndetectors = {near = \"tag\", far = \"tag\"}\n"),
      "odometry = \"odometry.tum\"\n", "odometry = \"odometry.tum\"\nimages = \"images.txt\"\n");
  const auto images_of = [&](const std::string& sequence, const char* image) {
    return job_of(sequence, kTable, image).sequence.images;
  };
  EXPECT_EQ(images_of(two, "0.05 left@far\n")[1], std::vector<std::string>{"left@far"});
  EXPECT_INVALID_WITH(images_of(two, "0.05 left@near\n0.10 left@typo\n"),
                      "images.txt:2: got an image of detector 'typo', expected one of: far, near");
  // An object that names no detectors takes any.
  const std::string one = replaced(two, "detectors = {near = \"tag\", far = \"tag\"}\n", "");
  EXPECT_EQ(images_of(one, "0.05 left@any\n")[1], std::vector<std::string>{"left@any"});
}

TEST(SequenceObservations, ErrorsOfStampsNameTheRow) {
  const std::string without = replaced(kSequence, "odometry = \"odometry.tum\"\n", "");
  EXPECT_INVALID_WITH(job_of(without, replaced(kTable, "\n0.10,left", "\n1.7e9,left")),
                      "observations.csv:5: got stamp_s = 1700000000, expected seconds of the clock "
                      "of the others, within 1e+07 s of the nearest, which is 0.05 (");
  EXPECT_INVALID_WITH(
      job_of(kSequence, replaced(kTable, "\n0.10,left", "\n1.7e6,left")),
      "observations.csv:5: got stamp_s = 1700000, expected seconds of the clock of ");
  EXPECT_INVALID_WITH(job_of(kSequence, replaced(kTable, "\n0.10,left", "\n1e13,left")),
                      "observations.csv:5: got stamp_s = \"1e13\", expected seconds");
}

TEST(SequenceObservations, ErrorsOfListedStampsNameTheRow) {
  const std::string with = replaced(kSequence, "odometry = \"odometry.tum\"\n",
                                    "odometry = \"odometry.tum\"\nimages = \"images.txt\"\n");
  const std::string without = replaced(with, "odometry = \"odometry.tum\"\n", "");
  EXPECT_INVALID_WITH(job_of(with),
                      "images.txt:2: got stamp = 1000000000, expected seconds of the clock of");
  EXPECT_INVALID_WITH(
      job_of(without),
      "images.txt:2: got stamp = 1000000000, expected seconds of the clock of the others");
}

TEST(SequenceObservations, ErrorsOfIdsNameTheRow) {
  EXPECT_INVALID_WITH(job_of(kSequence, replaced(kTable, "0.05,left,,9", "0.05,left,,a/../b")),
                      "observations.csv:4: got id = \"a/../b\", expected 1 to 100 letters");
}

TEST(SequenceObservations, ErrorsNameTheirFileOnce) {
  const std::string prior = std::string(kSequence) +
                            "[[objects]]\nid = \"7\"\nnoise = \"tag\"\n"
                            "prior = {pose = [1, 2, 3, 0, 0, 0, 1], translation_sd_m = 1}\n";
  EXPECT_INVALID_WITH(job_of(prior), "sequence.toml:");
  try {
    job_of(prior);
  } catch (const InvalidInput& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find("sequence.toml:"), message.rfind("sequence.toml:")) << message;
  }
}

TEST(SequenceObservations, NeedTheClockOfTheOdometry) {
  const std::string later = replaced(
      replaced(replaced(kTable, "\n0.05,", "\n9.05,"), "\n0.10,", "\n9.10,"), "\n0.00,", "\n9.00,");
  EXPECT_INVALID_WITH(job_of(kSequence, replaced(later, "\n0.00,", "\n9.00,")),
                      "goes from stamp 0 s to 0.1 s, expected stamps of the same clock");
}

TEST(SequenceObservations, MakeFramesObjectsAndDetections) {
  const SlamJob job = job_of(kSequence);
  ASSERT_EQ(job.sequence.stamps.size(), 3U);
  ASSERT_EQ(job.models.size(), 2U);
  EXPECT_EQ(job.models[0].id, "7");
  EXPECT_EQ(job.models[1].id, "9");
  ASSERT_EQ(job.sequence.observations.size(), 3U);
  EXPECT_EQ(job.sequence.observations[0][0].components.size(), 2U);
  EXPECT_NEAR(job.sequence.odometry[1]->translation().x(), 0.01, 1e-12);
  // The best component, from the body.
  EXPECT_NEAR(job.sequence.objects[0].detections[0]->translation().x(), 0.1, 1e-12);
  EXPECT_FALSE(job.sequence.objects[0].detections[1].has_value());
  const SlamRun result = run(job);
  EXPECT_EQ(result.hypotheses[0].size(), 2U);
  EXPECT_NEAR(result.frames.back().objects[1]->mean().translation().x(), 0.31, 0.01);
}

TEST(SequenceObservations, ObjectsOnSightAreInTheOrderOfTheirStamps) {
  const std::string head(kTable, std::string(kTable).find('\n') + 1);
  const auto row = [](double stamp, int id) {
    return fmt::format("{},left,,{},,{},1,0,0,1,0,0,0,1{}\n", stamp, id, id, std::string(21, ','));
  };
  std::vector<std::string> rows{row(0.0, 30), row(0.0, 4), row(0.1, 12), row(0.05, 5)};
  std::sort(rows.begin(), rows.end());
  do {
    const SlamJob job = job_of(kSequence, head + fmt::format("{}", fmt::join(rows, "")));
    std::vector<std::string> ids;
    for (const ObjectModel& model : job.models) ids.push_back(model.id);
    EXPECT_EQ(ids, (std::vector<std::string>{"30", "4", "5", "12"}));
  } while (std::next_permutation(rows.begin(), rows.end()));
}

TEST(SequenceObservations, MayBeLines) {
  const testing::TemporaryFolder folder;
  folder.put("odometry.tum", kOdometry);
  folder.put("observations.jsonl",
             format_observation_lines(parse_observations(kTable, "observations.csv")));
  const auto read = [&](const std::string& text) {
    return read_slam_job(TomlDocument::parse(text, "sequence.toml"), {folder.path()});
  };
  const std::string csv = "csv = \"observations.csv\"";
  const std::string lines = "jsonl = \"observations.jsonl\"";
  const SlamRun result = run(read(replaced(kSequence, csv, lines)));
  const SlamRun expected = run(job_of(kSequence));
  EXPECT_EQ(result.frames.back().objects[1]->mean().matrix(),
            expected.frames.back().objects[1]->mean().matrix());
  EXPECT_EQ(result.hypotheses[0].size(), 2U);
  try {
    read(replaced(kSequence, csv, csv + "\n" + lines));
    ADD_FAILURE() << "accepted two files";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("stands beside csv"), std::string::npos);
  }
}

TEST(SequenceObservations, StampsAreFramesToo) {
  const testing::TemporaryFolder folder;
  folder.put("odometry.tum", kOdometry);
  folder.put("observations.csv", kTable);
  folder.put("stamps.txt", "# images\n0.02\n0.1000000001\n");
  const auto text = replaced(kSequence, "[camera]\n", "[camera]\nstamps = \"stamps.txt\"\n");
  const auto job = [&] {
    return read_slam_job(TomlDocument::parse(text, "sequence.toml"), {folder.path()});
  };
  const std::vector<double> stamps{0.0, 0.02, 0.05, 0.1};
  EXPECT_EQ(job().sequence.stamps, stamps);
  EXPECT_NEAR(job().sequence.odometry[1]->translation().x(), 0.004, 1e-12);
  folder.put("stamps.txt", "0.02\nsoon\n");
  try {
    job();
    ADD_FAILURE() << "accepted a word";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("stamps.txt:2: "), std::string::npos) << error.what();
  }
}

TEST(SequenceObservations, ComeFromCamerasWithACovariance) {
  const SlamJob exact = job_of(kSequence);
  EXPECT_TRUE(std::get<MultiObjectSlamSettings>(exact.settings.tracker).cameras[0].is_exact());
  const std::string pose = "pose = [0.1, 0, 0, 0, 0, 0, 1]\n";
  const SlamJob job =
      job_of(replaced(kSequence, pose, pose + "rotation_sd_deg = 2\ntranslation_sd_m = 0.02\n"));
  const auto& camera = std::get<MultiObjectSlamSettings>(job.settings.tracker).cameras.at(0);
  ASSERT_TRUE(camera.covariance.has_value());
  EXPECT_NEAR(camera.covariance->diagonal()[0], std::pow(2 * std::numbers::pi / 180, 2), 1e-12);
  EXPECT_NEAR(camera.covariance->diagonal()[5], 4e-4, 1e-12);
  const SlamRun result = run(job);
  ASSERT_EQ(result.cameras.size(), 1U);
  EXPECT_FALSE(result.cameras[0].is_exact());
  const SlamJob zero =
      job_of(replaced(kSequence, pose, pose + "rotation_sd_deg = 0\ntranslation_sd_m = 0\n"));
  EXPECT_EQ(run(zero).frames.back().camera.mean().matrix(),
            run(exact).frames.back().camera.mean().matrix());
}

TEST(SequenceObservations, RefuseWhatDoesNotFit) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {replaced(kSequence, "[on_sight]\nnoise = \"tag\"\n", ""),
       "observations.csv:2: got id = \"7\", expected that of one of the [[objects]], of which "
       "there "
       "are none, or a table [on_sight]"},
      {replaced(kSequence, "noise = \"tag\"", "noise = \"tags\""), "no table [noise.tags]"},
      {replaced(kSequence, "name = \"left\"", "name = \"right\""),
       "observations.csv:2: got camera = \"left\", expected the name of one of the [[cameras]], "
       "one "
       "of: right"},
      {replaced(kSequence, "csv = \"observations.csv\"",
                "csv = \"observations.csv\"\ncamera = \"other\""),
       "sequence.toml:9: key 'observations.camera' is \"other\", expected the name of one of"},
      {replaced(kSequence, "csv = \"observations.csv\"", "csv = \"other.csv\""), "other.csv"},
      {replaced(kSequence, "[on_sight]",
                "[[objects]]\nid = \"7\"\nnoise = \"tag\"\ndetections = {tum = "
                "\"odometry.tum\"}\n[on_sight]"),
       "stands beside [[observations]]"},
      {replaced(kSequence, "[[cameras]]",
                "[[cameras]]\nname = \"left\"\npose = [0, 0, 0, 0, 0, 0, 1]\n[[cameras]]"),
       "two cameras have the name 'left'"},
      {replaced(kSequence, "[[cameras]]", "[[cameras]]\nrotation_sd_deg = 1"), "translation_sd_m"},
      {replaced(kSequence, "[[cameras]]", "[[cameras]]\nrotation_sd_deg = 1\ntranslation_sd_m = 0"),
       "key 'cameras[0].translation_sd_m' has a zero beside deviations above zero, expected"},
      {replaced(kSequence, "[[cameras]]",
                "[[cameras]]\nrotation_sd_deg = [0, 1, 1]\ntranslation_sd_m = 0.01"),
       "key 'cameras[0].rotation_sd_deg' has a zero beside deviations above zero, expected"},
      {replaced(kSequence, "[[cameras]]",
                "[[cameras]]\ncovariance = [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, "
                "0, 0], [0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 0]]"),
       "key 'cameras[0].covariance' is not positive definite, expected a symmetric"},
      {replaced(kSequence, "[[cameras]]", "[[cameras]]\nrotation_sd_deg = 1\ncovariance = []"),
       "stands beside standard deviations"},
  };
  for (const auto& [sequence, named] : cases) {
    try {
      job_of(sequence);
      ADD_FAILURE() << "accepted what should name " << named;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(job_of(kSequence, replaced(kTable, "0.4,0,0,1", "0.5,0,0,1")), InvalidInput);
}

}  // namespace
}  // namespace posemix
