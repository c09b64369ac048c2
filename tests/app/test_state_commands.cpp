// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/small_recording.hpp"
#include "posemix/io/posterior_file.hpp"
#include "posemix/results/state_file.hpp"
#include "run_program.hpp"

/// `posemix slam --save-state`, `posemix state` and `posemix relocalise`.
namespace posemix {
namespace {

using nlohmann::json;
using testing::content_of;
using testing::ProgramResult;
using testing::run_posemix;

class StateCommands : public ::testing::Test {
 protected:
  StateCommands() {
    // The recording by the default filter.
    const std::string text = content_of(small_.toml());
    std::ofstream(toml()) << text.substr(0, text.find("[filter]"));
  }
  ProgramResult slam(const std::vector<std::string>& more = {}) const {
    return slam_to(folder_ / "run", state(), more);
  }
  ProgramResult slam_to(const std::filesystem::path& out, const std::string& state,
                        const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{
        "slam",       toml(),         "--data", small_.folder.path().string(), "--quiet", "--out",
        out.string(), "--save-state", state};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_posemix(arguments);
  }
  std::string toml() const { return (folder_ / "default.toml").string(); }
  std::string state() const { return (folder_ / "map.state").string(); }

  testing::SmallFolder small_;
  testing::TemporaryFolder folder_;
};

/// Results whose names are those of the recording's own files would replace them.
TEST_F(StateCommands, NoInputIsReplaced) {
  const auto& folder = small_.folder.path();
  std::filesystem::rename(folder / "odometry.txt", folder / "camera.tum");
  std::string text = content_of(toml());
  text.replace(text.find("odometry.txt"), 12, "camera.tum");
  std::ofstream(toml()) << text;
  const std::string odometry = content_of(folder / "camera.tum");

  const ProgramResult over_odometry = slam_to(folder, state());
  EXPECT_EQ(over_odometry.exit_code, 3) << over_odometry.err;
  EXPECT_NE(over_odometry.err.find("camera.tum: is an input of this command"), std::string::npos)
      << over_odometry.err;
  EXPECT_EQ(content_of(folder / "camera.tum"), odometry);
  EXPECT_FALSE(std::filesystem::exists(folder / "metrics.json"));
  EXPECT_FALSE(std::filesystem::exists(state()));

  const ProgramResult over_sequence = slam_to(folder_ / "run", toml());
  EXPECT_EQ(over_sequence.exit_code, 3) << over_sequence.err;
  EXPECT_EQ(content_of(toml()), text);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));

  // Results of before are no input, with a report of them or without.
  for (int run = 0; run < 3; ++run) EXPECT_EQ(slam({"--report"}).exit_code, 0) << run;
}

/// The later of the two would replace the other in silence.
TEST_F(StateCommands, NoResultOfTheSameRunIsReplaced) {
  const std::string run = (folder_ / "run").string();
  std::filesystem::create_directory(run);
  std::filesystem::create_symlink("run", folder_ / "link");
  for (const std::string name : {"metrics.json", "object_mug.tum", "mixture_box.json"}) {
    for (const std::string& path : {run + "/" + name, run + "/../link/./" + name}) {
      const ProgramResult result = slam_to(run, path);
      EXPECT_EQ(result.exit_code, 2) << path;
      EXPECT_NE(result.err.find("--save-state: " + path + " is a result in the folder of --out"),
                std::string::npos)
          << result.err;
    }
  }
  const ProgramResult folder = slam_to(run, run);
  EXPECT_EQ(folder.exit_code, 2);
  EXPECT_NE(folder.err.find("--save-state: is the folder of --out"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(run));
  EXPECT_EQ(slam_to(run, run + "/map.state").exit_code, 0);
}

TEST_F(StateCommands, SlamSavesItsState) {
  const ProgramResult result = slam();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto saved = std::get<MultiObjectSlam>(load_state(state()));
  ASSERT_EQ(saved.objects().size(), 3U);
  EXPECT_EQ(saved.detections(1), testing::kSmallFrames);
  // It goes on from where the run's results end.
  const PosteriorFile last = read_posterior(folder_ / "run/posterior.json");
  const auto& mean = last.mixture[0].density.mean();
  EXPECT_TRUE(saved.estimate().mean().is_approx(mean, 1e-12));
  const ProgramResult shown = run_posemix({"state", state(), "--json"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  const json found = json::parse(shown.out);
  EXPECT_EQ(found["kind"], "frames");
  EXPECT_EQ(found["format"], kStateFormat);
  EXPECT_EQ(found["objects"]["box"]["detections"], testing::kSmallFrames);
  EXPECT_GT(found["objects"]["can"]["existence"], 0.5);
  const ProgramResult table = run_posemix({"state", state()});
  EXPECT_NE(table.out.find("  mug:"), std::string::npos) << table.out;
}

TEST_F(StateCommands, WhatHasNoStateIsRefused) {
  const ProgramResult smoothed = slam({"--smooth"});
  EXPECT_EQ(smoothed.exit_code, 3);
  EXPECT_NE(smoothed.err.find("a smoothed run has no state"), std::string::npos) << smoothed.err;
  const ProgramResult particles = slam({"--set", "filter.method=rbpf"});
  EXPECT_EQ(particles.exit_code, 3);
  EXPECT_NE(particles.err.find("expected the multi-object filter"), std::string::npos)
      << particles.err;
  // Before the filter runs.
  const ProgramResult nowhere = run_posemix(
      {"slam", toml(), "--data", small_.folder.path().string(), "--out", (folder_ / "run").string(),
       "--save-state", (folder_ / "no/map.state").string()});
  EXPECT_EQ(nowhere.exit_code, 3);
  EXPECT_NE(nowhere.err.find("posemix: error: --save-state " + (folder_ / "no").string()),
            std::string::npos)
      << nowhere.err;
  EXPECT_NE(nowhere.err.find("there is no folder"), std::string::npos) << nowhere.err;
  const ProgramResult taken = slam_to(folder_ / "run", folder_.path().string());
  EXPECT_EQ(taken.exit_code, 3);
  EXPECT_NE(taken.err.find("is a folder, expected a file"), std::string::npos) << taken.err;
  const ProgramResult nameless = slam_to(folder_ / "run", "");
  EXPECT_EQ(nameless.exit_code, 3);
  EXPECT_NE(nameless.err.find("--save-state : there is no folder"), std::string::npos)
      << nameless.err;
  EXPECT_FALSE(std::filesystem::exists(state()));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
  const ProgramResult none = run_posemix({"state", toml()});
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_NE(none.err.find("default.toml: this is not a saved state"), std::string::npos)
      << none.err;
  EXPECT_EQ(run_posemix({"state", "/nowhere.state"}).exit_code, 3);
}

TEST_F(StateCommands, AMapIsFoundInItself) {
  ASSERT_EQ(slam().exit_code, 0);
  const ProgramResult result = run_posemix({"relocalise", state(), state(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json found = json::parse(result.out);
  EXPECT_EQ(found["outcome"], "found");
  EXPECT_EQ(found["agreed"], (json{{"mug", "mug"}, {"box", "box"}, {"can", "can"}}));
  for (const double x : found["T_new_old"]["translation_m"]) EXPECT_NEAR(x, 0.0, 1e-6);
  EXPECT_EQ(found["objects"].size(), 3U);
  const ProgramResult few =
      run_posemix({"relocalise", state(), state(), "--json", "--least-objects", "4"});
  EXPECT_EQ(few.exit_code, 0);
  EXPECT_EQ(json::parse(few.out)["outcome"], "too_few_shared");
}

}  // namespace
}  // namespace posemix
