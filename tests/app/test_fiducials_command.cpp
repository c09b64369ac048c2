// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mixture_folder.hpp"
#include "posemix/io/observation_csv.hpp"
#include "posemix/testing/data.hpp"

/// `posemix fiducials`.
namespace posemix {
namespace {

using testing::contains;
using testing::ProgramResult;
using Json = nlohmann::json;

constexpr const char* kHeader =
    "stamp_s,topic,tag,u0_px,v0_px,u1_px,v1_px,u2_px,v2_px,u3_px,v3_px\n";

class FiducialsCommand : public testing::MixtureFolder {
 protected:
  FiducialsCommand() {
    folder_.put("cameras.yaml",
                "cam0:\n  intrinsics: [600, 602, 640, 512]\n  distortion_model: none\n"
                "  tagtopic: /tags\n");
    folder_.put("corners.csv", std::string(kHeader) +
                                   "1.5,/tags,7,500.2,300.1,531.5,301.9,532.3,270.4,500.9,268.8\n"
                                   "1.6,/tags,7,640.3,520.2,648.9,528.4,650.1,479.5,641.0,473.2\n");
  }
};

TEST_F(FiducialsCommand, WritesObservationsWithBothPoses) {
  const ProgramResult result =
      shell("posemix fiducials corners.csv --cameras cameras.yaml --size 0.15 -o out --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  const Json found = Json::parse(result.err);
  EXPECT_EQ(found["sightings"], 2);
  EXPECT_EQ(found["observations"], 2);
  EXPECT_EQ(found["tags"], 1);
  EXPECT_EQ(found["corner_noise"]["cam0"]["source"], "assumed");
  EXPECT_EQ(testing::names_in(folder_.path() / "out"),
            (std::vector<std::string>{"cameras.csv", "corner_noise.csv", "observations.csv",
                                      "sequence.toml"}));
  const auto observations = read_observations(folder_.path() / "out/observations.csv");
  ASSERT_EQ(observations.size(), 2U);
  EXPECT_EQ(observations[0].components.size(), 2U);
  EXPECT_EQ(observations[0].object, "7");
  EXPECT_EQ(observations[1].stamp_s, 1.6);
}

TEST_F(FiducialsCommand, WarnsOfWhatIsHardlyTrue) {
  const std::string command = "posemix fiducials corners.csv --cameras cameras.yaml -o out --quiet";
  const ProgramResult good = shell(command + " --size 0.15");
  EXPECT_EQ(good.err, "");
  const ProgramResult size = shell(command + " --size 150");
  EXPECT_EQ(size.exit_code, 0);
  EXPECT_TRUE(contains(size.err, "posemix: warning: a tag has an edge of 150 m")) << size.err;
  const ProgramResult noise = shell(command + " --size 0.15 --corner-noise 119");
  EXPECT_TRUE(contains(noise.err, "the stated noise of the corners of camera \"cam0\" is 119 px"))
      << noise.err;
}

TEST_F(FiducialsCommand, TakesANoiseAndCompresses) {
  const ProgramResult result = shell(
      "posemix fiducials corners.csv --cameras cameras.yaml --size 0.15 --corner-noise 0.05 --gzip "
      "--detector april --quiet -o out");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const auto observations = read_observations(folder_.path() / "out/observations.csv.gz");
  EXPECT_EQ(observations[0].components.size(), 1U);
  EXPECT_EQ(observations[0].detector, "april");
}

TEST_F(FiducialsCommand, RefusesBadInputAndLeavesNothing) {
  const std::string command = "posemix fiducials corners.csv --cameras cameras.yaml -o out";
  expect_error(command, 2, "expected --size or --tags");
  expect_error(command + " --size -1", 2, "--size");
  expect_error(command + " --size 0.1 --corner-dof 3", 2, "--corner-noise");
  for (const std::string option : {"--size", "--corner-noise", "--bearing-error"})
    expect_error(command + " --tags t.yaml " + option + " 1e300", 2, option + ": got 1e300");
  expect_error(command + " --size 0.1 --corner-noise 1 --corner-dof 1e-300", 2, "--corner-dof");
  expect_error(command + " --size 0.1 --odometry missing.tum", 3, "missing.tum");
  for (const std::string option : {"--odometry", "--tags", "--camera-poses"})
    expect_error(command + " --size 0.1 " + option + " ''", 2, option + ": got an empty name");
  folder_.put("corners.csv", std::string(kHeader) + "1.5,/other,7,1,1,2,1,2,2,1,2\n");
  expect_error(command + " --size 0.15", 3, "corners.csv:2: got the topic \"/other\"");
  folder_.put("cameras.yaml", "cam0:\n  intrinsics: [600, 602, 640]\n");
  expect_error(command + " --size 0.15", 3,
               "cameras.yaml:2: cam0.intrinsics: got 3 numbers, expected 4");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out"));
}

TEST_F(FiducialsCommand, DoubtsWhatTheTagsContradict) {
  POSEMIX_REQUIRE_DATA();
  const std::string data = testing::data_dir()->string();
  const auto run = [&](const std::string& test, const std::string& more) {
    return shell("D='" + data + "/tagslam/" + test + "'; " + more +
                 " && posemix fiducials corners.csv --cameras $D/cameras.yaml --camera-poses "
                 "$D/camera_poses.yaml --tags $D/tagslam.yaml -o out --quiet $O");
  };
  const ProgramResult millimetres =
      run("test_11",
          "zcat $D/corners.csv.gz > corners.csv; zcat $D/odometry.tum.gz | awk '/^[0-9]/ {$2 *= "
          "1000; $3 *= 1000; $4 *= 1000} {print}' > mm.tum; O='--odometry mm.tum'");
  EXPECT_EQ(millimetres.exit_code, 0);
  EXPECT_TRUE(contains(millimetres.err, "mm.tum: against the tags it errs by")) << millimetres.err;
  const ProgramResult unplaced =
      run("test_5", "O=; zcat $D/corners.csv.gz | grep -v quadruple/bottom_left/ > corners.csv");
  EXPECT_EQ(unplaced.exit_code, 3);
  EXPECT_TRUE(contains(unplaced.err, "no camera with a pose on the rig sees a tag"))
      << unplaced.err;
}

TEST_F(FiducialsCommand, ReadsTheRecordingsOfTagSlam) {
  POSEMIX_REQUIRE_DATA();
  const std::string data = (*testing::data_dir() / "tagslam/test_11").string();
  const ProgramResult result = shell(
      "D='" + data +
      "' && posemix fiducials $D/corners.csv.gz --cameras $D/cameras.yaml --camera-poses "
      "$D/camera_poses.yaml --tags $D/tagslam.yaml --odometry $D/odometry.tum.gz -o out --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json found = Json::parse(result.err);
  EXPECT_EQ(found["sightings"], 3635);
  EXPECT_EQ(found["observations"], 3634);
  EXPECT_EQ(found["tags"], 20);
  EXPECT_EQ(found["tags_with_prior"], 82);
  EXPECT_EQ(found["corner_noise"]["cam1"]["source"], "own");
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out/odometry.tum"));
}

}  // namespace
}  // namespace posemix
