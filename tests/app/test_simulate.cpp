// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <gtest/gtest.h>

#include "posemix/results/report.hpp"
#include "run_program.hpp"

namespace posemix {
namespace {

using testing::content_of;
using testing::names_in;
using testing::ProgramResult;
using testing::run_posemix;

const std::string kSource = POSEMIX_SOURCE_DIR;

class Simulate : public ::testing::Test {
 protected:
  ProgramResult simulate(const std::string& name, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"simulate", kSource + "/configs/demo.toml", "--out",
                                       (results_ / name).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_posemix(arguments);
  }

  testing::TemporaryFolder results_;
};

TEST_F(Simulate, WritesARecordingThatSlamReads) {
  const ProgramResult result = simulate("a", {"--set", "camera.frames=210"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out,
            "210 simulated frames, 5 objects: " + (results_ / "a/sequence.toml").string() + "\n");
  const std::vector<std::string> names = names_in(results_ / "a");
  EXPECT_EQ(names.size(), 13U);
  for (const std::string name : {"sequence.toml", "odometry.tum", "detections_mug.tum"}) {
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  }
  const ProgramResult slam = run_posemix(
      {"slam", (results_ / "a/sequence.toml").string(), "--out", (results_ / "b").string()});
  EXPECT_EQ(slam.exit_code, 0) << slam.err;
  // Estimates stand beside detections over the same frames.
  EXPECT_NE(slam.out.find("\nMedian errors relative to the camera"), std::string::npos) << slam.out;
}

TEST_F(Simulate, ScenesOfMovingObjectsRunThroughSlam) {
  for (const std::string name : {"moving-table", "conveyor", "hand-held", "pick-and-place",
                                 "hand-over", "crossing", "come-and-go"}) {
    const std::string recording = (results_ / name).string();
    const ProgramResult made = run_posemix({"simulate", kSource + "/configs/" + name + ".toml",
                                            "--set", "camera.frames=150", "--out", recording});
    ASSERT_EQ(made.exit_code, 0) << name << ": " << made.err;
    const ProgramResult slam = run_posemix(
        {"slam", recording + "/sequence.toml", "--out", (results_ / (name + "-slam")).string()});
    EXPECT_EQ(slam.exit_code, 0) << name << ": " << slam.err;
  }
}

TEST_F(Simulate, TheSeedDecides) {
  for (const std::string name : {"a", "b"}) simulate(name, {"--seed", "7", "--quiet"});
  EXPECT_EQ(simulate("c", {"--seed", "18446744073709551615", "--quiet"}).out, "");
  const auto odometry = [&](const std::string& name) {
    return content_of(results_ / (name + "/odometry.tum"));
  };
  EXPECT_EQ(odometry("a"), odometry("b"));
  EXPECT_NE(odometry("a"), odometry("c"));
}

TEST_F(Simulate, MistakesLeaveNothing) {
  EXPECT_EQ(simulate("a", {"--seed", "-1"}).exit_code, 2);
  EXPECT_EQ(simulate("a", {"--seed", "1.5"}).exit_code, 2);
  const ProgramResult unknown = simulate("a", {"--set", "camera.frame=3"});
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_EQ(unknown.err,
            "posemix: error: --set camera.frame=3: unknown key 'camera.frame', did you mean "
            "'frames'?\n");
  EXPECT_EQ(
      run_posemix({"simulate", "/nowhere.toml", "--out", (results_ / "a").string()}).exit_code, 3);
  EXPECT_EQ(names_in(results_.path()), std::vector<std::string>{});
}

TEST_F(Simulate, DemoComparesThreeFilters) {
  testing::RunningProgram demo(
      {POSEMIX_PYTHON, kSource + "/tools/demo", POSEMIX_PROGRAM, (results_ / "demo").string()});
  const ProgramResult result = demo.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.out.starts_with("Simulated data")) << result.out;
  for (const std::string part : {"\ncamera ", "\nmug ", "\nlate-cup ", "picture.svg"}) {
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(names_in(results_ / "demo"),
            (std::vector<std::string>{"comparison.html", "gm-iekf", "multi-object", "riekf",
                                      "sequence"}));
  const std::string page = (results_ / "demo/comparison.html").string();
  EXPECT_TRUE(result.out.ends_with("file://" + page + "\n")) << result.out;
  EXPECT_GT(std::filesystem::file_size(page), 100000U);
}

}  // namespace
}  // namespace posemix
