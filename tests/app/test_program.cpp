// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <chrono>
#include <fstream>
#include <regex>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/small_recording.hpp"
#include "posemix/io/posterior_file.hpp"
#include "run_program.hpp"

namespace posemix {
namespace {

using nlohmann::json;
using testing::contains;
using testing::content_of;
using testing::names_in;
using testing::ProgramResult;
using testing::run_posemix;
using testing::SmallFolder;
using testing::TemporaryFolder;

/// One line with the prefix of every error message.
void expect_error(const ProgramResult& result, int exit_code, const std::string& part) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_TRUE(result.err.starts_with("posemix: error: ")) << result.err;
  EXPECT_TRUE(contains(result.err, part)) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.out, "");
}

TEST(Program, HelpHasAnExampleForEveryCommand) {
  const ProgramResult program = run_posemix({"--help"});
  EXPECT_EQ(program.exit_code, 0);
  EXPECT_TRUE(contains(program.out, "Exit codes: 0 done")) << program.out;
  EXPECT_TRUE(contains(program.out, "Example: posemix ")) << program.out;
  for (const std::string command : {"slam", "live", "simulate", "study", "report", "data"}) {
    EXPECT_TRUE(contains(program.out, command));
    const ProgramResult help = run_posemix({command, "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_TRUE(contains(help.out, "Example: posemix " + command)) << help.out;
    EXPECT_EQ(help.err, "");
  }
}

TEST(Program, Version) {
  const ProgramResult result = run_posemix({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.out.starts_with("posemix ")) << result.out;
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '.'), 2);
}

TEST(Program, WrongUsage) {
  expect_error(run_posemix({"fly"}), 2, "unknown command 'fly', expected one of slam, live, ");
  expect_error(run_posemix({"slamm", "a.toml", "--out", "x"}), 2,
               "unknown command 'slamm', did you mean 'slam'?; see `posemix --help`");
  expect_error(run_posemix({"study", "salt-bx"}), 2,
               "unknown study 'salt-bx', did you mean 'salt-box'?; see `posemix study --help`");
  expect_error(run_posemix({"study", "salt"}), 2, "did you mean 'salt-box'?");
  expect_error(run_posemix({"data", "fetsh"}), 2, "unknown command 'fetsh', did you mean 'fetch'?");
  expect_error(run_posemix({"--loud"}), 2, "unknown option '--loud'; see `posemix --help`");
  expect_error(run_posemix({"slam"}), 2, "`posemix slam --help`");
  expect_error(run_posemix({"slam", "a.toml"}), 2, "--out is required");
  expect_error(run_posemix({"slam", "a.toml", "--out", "x", "--frobnicate"}), 2, "--frobnicate");
}

TEST(Program, WithoutACommandThereIsHelp) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{}, std::vector<std::string>{"study"}, {"data"}}) {
    const ProgramResult result = run_posemix(words);
    std::vector<std::string> asked = words;
    asked.push_back("--help");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(result.err.starts_with(run_posemix(asked).out)) << result.err;
    EXPECT_TRUE(contains(result.err, "\nposemix: error: got no ")) << result.err;
  }
}

class Slam : public ::testing::Test {
 protected:
  ProgramResult slam(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"slam", small_.toml().string(), "--out", out().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_posemix(arguments);
  }
  std::filesystem::path out() const { return results_ / "run"; }

  SmallFolder small_;
  TemporaryFolder results_;
};

TEST_F(Slam, WritesAllFilesAndPrintsATable) {
  const ProgramResult result = slam();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "") << "no progress bar in a pipe";
  EXPECT_TRUE(contains(result.out, " 0001: gm-iekf (midway), 20 frames")) << result.out;
  EXPECT_TRUE(contains(result.out, "\nmug ")) << result.out;
  EXPECT_EQ(names_in(out()),
            (std::vector<std::string>{"camera.tum", "metrics.json", "object_box.tum",
                                      "object_can.tum", "object_mug.tum", "picture.svg",
                                      "posterior.json", "relative_box.tum", "relative_can.tum",
                                      "relative_mug.tum", "trace.json"}));
  EXPECT_EQ(names_in(results_.path()), std::vector<std::string>{"run"});
  EXPECT_EQ(read_posterior(out() / "posterior.json").poses.size(), 4U);
}

TEST_F(Slam, TheTableHasUnitsAndAVerdictForEveryPose) {
  const ProgramResult result = slam();
  const json metrics = json::parse(content_of(out() / "metrics.json"));
  const double rmse_m = metrics["camera"]["position_rmse_m"];
  EXPECT_TRUE(contains(result.out, fmt::format("\ncamera  {:9.2f}", 1e3 * rmse_m))) << result.out;
  const std::size_t heading = result.out.find(" world ");
  EXPECT_LT(heading, result.out.find("[mm]   [deg]")) << result.out;
  ASSERT_EQ(metrics["consistency"]["relative_anees"].size(), 3U);
  for (const auto& [id, anees] : metrics["consistency"]["relative_anees"].items()) {
    const json& verdict = metrics["consistency"]["relative_verdicts"][id];
    EXPECT_NEAR(verdict["anees"].get<double>(), anees.get<double>(), 1e-9) << id;
    const double low = verdict["interval"][0];
    const double high = verdict["interval"][1];
    EXPECT_LT(low, verdict["anees"]) << id;
    EXPECT_GT(high, verdict["anees"]) << id;
    EXPECT_TRUE(contains(
        result.out,
        fmt::format("  {} (mean NEES {:.2f} (1 expected), 95 % interval {:.2f} to "
                    "{:.2f})",
                    verdict["verdict"].get<std::string>(), anees.get<double>(), low, high)))
        << id << ": " << result.out;
    // Where an axis or direction is at fault though the interval holds 1, the reason says so.
    EXPECT_TRUE(verdict["verdict"] == "consistent" ||
                !verdict["reason"].get<std::string>().empty());
  }
}

TEST_F(Slam, ColoursOnATerminalOnlyAndNotWithNoColor) {
  const auto shown = [&](std::vector<std::string> before) {
    for (const std::string& word : {std::string(POSEMIX_PROGRAM), std::string("slam"),
                                    small_.toml().string(), std::string("--out"), out().string()})
      before.push_back(word);
    return testing::terminal_output(before);
  };
  const std::regex colour("\033\\[3[123]m(consistent|overconfident|cautious)\033\\[0m");
  const std::string with = shown({"/usr/bin/env", "-u", "NO_COLOR", "TERM=xterm"});
  EXPECT_TRUE(std::regex_search(with, colour)) << with;
  EXPECT_FALSE(std::regex_search(shown({"/usr/bin/env", "TERM=xterm", "NO_COLOR=1"}), colour));
  EXPECT_FALSE(std::regex_search(shown({"/usr/bin/env", "-u", "NO_COLOR", "TERM=dumb"}), colour));
  EXPECT_FALSE(contains(slam().out, "\033"));
}

TEST_F(Slam, JsonPrintsTheMetrics) {
  const ProgramResult result = slam({"--json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, content_of(out() / "metrics.json"));
  EXPECT_EQ(json::parse(result.out)["frames"], 20);
}

TEST_F(Slam, Smooths) {
  const std::string file = (results_ / "smooth.toml").string();
  const std::string text = content_of(small_.toml());
  std::ofstream(file) << text.substr(0, text.find("[filter]"));
  const auto method = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{
        "slam", file, "--data", small_.folder.path().string(), "--json", "--out", out().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_posemix(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out)["method"].get<std::string>();
  };
  EXPECT_EQ(method({"--smooth"}), "multi-object, smoothed");
  EXPECT_EQ(method({"--smooth-lag", "3"}), "multi-object, smoothed by 3 frames");
  expect_error(slam({"--smooth"}), 3, "no other filter is smoothed");
  expect_error(slam({"--smooth", "--smooth-lag", "3"}), 2, "--smooth");
}

TEST_F(Slam, SmoothingIsNamedAsItWasGiven) {
  expect_error(slam({"--smooth"}), 3, "posemix: error: --smooth: key 'filter.smooth' is for");
  expect_error(slam({"--smooth-lag", "3"}), 3,
               "posemix: error: --smooth-lag 3: key 'filter.smooth");
  expect_error(slam({"--smooth-lag", "0"}), 2,
               "--smooth-lag: got \"0\", expected an integer from 1");
  expect_error(slam({"--smooth-lag", "3", "--set", "filter.smooth=full"}), 2,
               "--smooth-lag 3: got --set filter.smooth=full too, expected one of them");
  expect_error(slam({"--set", "filter.smooth_lag=3", "--smooth"}), 2,
               "--smooth: got --set filter.smooth_lag=3 too, expected one of them");
  EXPECT_EQ(names_in(results_.path()), std::vector<std::string>{});
}

TEST_F(Slam, NoOverrideReplacesAnother) {
  expect_error(slam({"--set", "filter.max_components=2", "--set", "filter.max_components=3"}), 2,
               "--set: \"filter.max_components=3\" replaces \"filter.max_components=2\", expected "
               "one value for a key");
  expect_error(slam({"--set", "filter.\"method\"=riekf", "--set", "filter.method=midway"}), 2,
               "replaces");
  expect_error(slam({"--set", "filter.method=riekf", "--set", "filter={}"}), 2, "replaces");
  const ProgramResult within =
      slam({"--set", "filter={}", "--set", "filter.method=riekf", "--json"});
  EXPECT_EQ(within.exit_code, 0) << within.err;
  EXPECT_TRUE(json::parse(within.out)["method"].get<std::string>().starts_with("riekf"));
}

TEST_F(Slam, QuietPrintsNothing) {
  const ProgramResult result = slam({"--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out + result.err, "");
}

TEST_F(Slam, AProgressBarOnATerminalOnly) {
  const std::vector<std::string> command{POSEMIX_PROGRAM, "slam", small_.toml().string(), "--out",
                                         out().string()};
  const std::string shown = testing::terminal_output(command);
  EXPECT_TRUE(contains(shown, "[#")) << shown;
  EXPECT_TRUE(contains(shown, "/20 frames")) << shown;
  EXPECT_TRUE(contains(shown, "\r\033[K")) << "the bar is erased";
  std::vector<std::string> quiet = command;
  quiet.push_back("--quiet");
  EXPECT_EQ(testing::terminal_output(quiet), "");
}

TEST_F(Slam, OverridesAndDataFolder) {
  const std::string elsewhere = (results_ / "copy.toml").string();
  std::filesystem::copy(small_.toml(), elsewhere);
  const ProgramResult result = run_posemix(
      {"slam", elsewhere, "--data", small_.folder.path().string(), "--set", "filter.method=riekf",
       "--set", "filter.gate_probability=0.5", "--json", "--out", out().string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(json::parse(result.out)["method"], "riekf (gate 0.5)");
  expect_error(
      run_posemix({"slam", elsewhere, "--out", (results_ / "b").string(), "--data", "/nowhere"}), 3,
      "/nowhere: is not a folder");
}

TEST_F(Slam, BadInputLeavesNothing) {
  expect_error(slam({"--set", "filter.gate=1"}), 3,
               "--set filter.gate=1: unknown key 'filter.gate'");
  expect_error(slam({"--set", "filter"}), 3, "expected key=value");
  expect_error(run_posemix({"slam", "/nowhere.toml", "--out", out().string()}), 3,
               "/nowhere.toml: cannot be read");
  EXPECT_EQ(names_in(results_.path()), std::vector<std::string>{});
}

TEST_F(Slam, OutputThatCannotBeWritten) {
  const std::string file = results_.put("file", "x").string();
  const std::vector<std::string> command{"slam", small_.toml().string(), "--out"};
  const auto into = [&](const std::string& folder) {
    std::vector<std::string> arguments = command;
    arguments.push_back(folder);
    return run_posemix(arguments);
  };
  expect_error(into(file), 4, "not a folder");
  expect_error(into(file + "/below"), 4, file);
  expect_error(into(""), 4, "cannot be written");
  EXPECT_EQ(names_in(results_.path()), std::vector<std::string>{"file"});
}

TEST_F(Slam, FullStandardOutputIsAnError) {
  testing::RunningProgram program(
      {POSEMIX_PROGRAM, "slam", small_.toml().string(), "--out", out().string()}, "/dev/full");
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_EQ(result.err, "posemix: error: standard output: cannot be written\n");
}

TEST_F(Slam, AnotherRunReplacesTheFiles) {
  EXPECT_EQ(slam().exit_code, 0);
  const std::string before = content_of(out() / "camera.tum");
  EXPECT_EQ(slam({"--set", "filter.method=riekf"}).exit_code, 0);
  EXPECT_NE(content_of(out() / "camera.tum"), before);
  EXPECT_EQ(names_in(results_.path()), std::vector<std::string>{"run"});
}

/// A long recording, so that there is time to interrupt it.
std::string long_tum(std::size_t frames) {
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < frames; ++k)
    poses.push_back({0.1 * static_cast<double>(k), SE3d(SO3d(), {0, 0, 0.5})});
  return format_tum(poses);
}

TEST_F(Slam, AnInterruptLeavesNothing) {
  small_.folder.put("long.txt", long_tum(200000));
  small_.folder.put("long.toml", R"(schema = 1
[camera]
odometry = "long.txt"
[noise.n]
components = [{weight = 1, rotation_sd_deg = 3, translation_sd_m = 0.1}, {weight = 1, rotation_sd_deg = 9, translation_sd_m = 0.1}]
[[objects]]
id = "a"
noise = "n"
detections = {tum = "long.txt"}
[filter]
method = "gm-iekf"
max_components = 64
)");
  for (const int signal : {SIGINT, SIGTERM}) {
    testing::RunningProgram program({POSEMIX_PROGRAM, "slam",
                                     (small_.folder / "long.toml").string(), "--out",
                                     (results_ / "a/b").string()});
    while (!program.has_ended() && names_in(results_.path()).empty()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    program.send(signal);
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 128 + signal) << result.err;
    EXPECT_EQ(result.err, "posemix: error: interrupted\n");
    EXPECT_EQ(names_in(results_.path()), std::vector<std::string>{});
  }
}

TEST_F(Slam, ThePictureIsXml) {
  EXPECT_EQ(slam().exit_code, 0);
  const std::string check =
      "import sys, xml.etree.ElementTree as e; assert "
      "e.parse(sys.argv[1]).getroot().tag.endswith('svg')";
  testing::RunningProgram python({POSEMIX_PYTHON, "-c", check, (out() / "picture.svg").string()});
  const ProgramResult result = python.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

}  // namespace
}  // namespace posemix
