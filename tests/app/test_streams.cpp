// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "config/small_recording.hpp"
#include "run_program.hpp"

/// Pipes that nobody reads or writes, and standard streams that are closed.
namespace posemix {
namespace {

namespace fs = std::filesystem;

using testing::ProgramResult;
using testing::RunningProgram;

class Streams : public ::testing::Test {
 protected:
  Streams() {
    mkfifo(pipe().c_str(), 0600);
    // The recording by the default filter.
    const std::string text = testing::content_of(small_.toml());
    folder_.put("default.toml", text.substr(0, text.find("[filter]")));
  }

  std::vector<std::string> slam() const {
    return {POSEMIX_PROGRAM,
            "slam",
            (folder_ / "default.toml").string(),
            "--data",
            small_.folder.path().string(),
            "--out",
            out()};
  }

  std::string pipe() const { return (folder_ / "pipe").string(); }
  std::string out() const { return (folder_ / "out").string(); }

  /// Sends one signal to a program that waits, once a file is there.
  static ProgramResult stopped(const std::vector<std::string>& command, int signal,
                               const fs::path& awaited = {}) {
    RunningProgram program(command);
    while (!awaited.empty() && !fs::exists(awaited) && !program.has_ended()) pause(10);
    pause(300);
    program.send(signal);
    for (int i = 0; i < 500 && !program.has_ended(); ++i) pause(10);
    EXPECT_TRUE(program.has_ended());
    if (!program.has_ended()) program.send(SIGKILL);
    return program.wait();
  }
  static void pause(int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  }

  testing::SmallFolder small_;
  testing::TemporaryFolder folder_;
};

TEST_F(Streams, ASignalEndsTheWaitForAnInputAndIsNoErrorOfIt) {
  const std::vector<std::vector<std::string>> commands{
      {"slam", pipe(), "--out", out()},
      {"simulate", pipe(), "--out", out()},
      {"study", "monte-carlo", pipe(), "--out", out()},
      {"fuse-views", pipe(), "--cameras", pipe(), "--groups", "3", "--out", out()},
      {"reduce", pipe(), "--to", "1"}};
  for (std::vector<std::string> command : commands) {
    SCOPED_TRACE(command.front());
    const bool has_guard = command.front() != "reduce";
    command.insert(command.begin(), POSEMIX_PROGRAM);
    for (const int signal : {SIGTERM, SIGINT}) {
      const ProgramResult result = stopped(command, signal);
      EXPECT_EQ(result.exit_code, 128 + signal) << result.err;
      EXPECT_EQ(result.err, has_guard ? "posemix: error: interrupted\n" : "");
      EXPECT_FALSE(fs::exists(out()));
    }
  }
}

TEST_F(Streams, ASignalEndsTheWaitForAReaderOfTheState) {
  std::vector<std::string> command = slam();
  command.insert(command.end(), {"--quiet", "--save-state", pipe()});
  const ProgramResult result = stopped(command, SIGTERM, folder_ / "out/metrics.json");
  EXPECT_EQ(result.exit_code, 143) << result.err;
  EXPECT_TRUE(result.err.ends_with("posemix: error: interrupted\n")) << result.err;
  EXPECT_TRUE(fs::exists(out() + "/trace.json"));
}

/// What a shell starts in the background ignores interrupts, and so do its children.
TEST_F(Streams, AProgramOfTheTestsIsInterruptedWhereTheyAreNot) {
  const auto before = std::signal(SIGINT, SIG_IGN);
  RunningProgram program({"/bin/sleep", "10"});
  std::signal(SIGINT, before);
  while (!program.has_ended()) {
    program.send(SIGINT);
    pause(10);
  }
  EXPECT_EQ(program.wait().exit_code, 128 + SIGINT);
}

/// A file that is opened later is none of them.
TEST_F(Streams, WhatIsPrintedToAClosedOutputIsAnErrorWhateverElseIsClosed) {
  for (const std::string closed : {">&-", "<&- >&-", "<&- >&- 2>&-"}) {
    SCOPED_TRACE(closed);
    std::vector<std::string> command = slam();
    command.insert(command.begin(), {"/bin/bash", "-c", "\"$@\" " + closed, "bash"});
    const ProgramResult result = RunningProgram(command).wait();
    EXPECT_EQ(result.exit_code, 4);
    const std::string error = "posemix: error: standard output: cannot be written\n";
    EXPECT_TRUE(result.err.ends_with(error) || closed.ends_with("2>&-")) << result.err;
    EXPECT_TRUE(fs::exists(out() + "/metrics.json"));
  }
  const ProgramResult nothing = RunningProgram({"/bin/bash", "-c", "\"$@\" <&- >&-", "bash",
                                                POSEMIX_PROGRAM, "reduce", "-", "--to", "1"})
                                    .wait();
  EXPECT_EQ(nothing.exit_code, 3);
  EXPECT_EQ(nothing.err, "posemix: error: standard input: cannot be read\n");
}

}  // namespace
}  // namespace posemix
