// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Limits of the system, other processes, closed pipes, and kills at any moment: a message, an exit
// code of the table, and nothing lost.
#include <array>
#include <chrono>
#include <iostream>
#include <random>
#include <set>
#include <thread>

#include <unistd.h>

#include <gtest/gtest.h>

#include "subjects.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

using testing::FaultyRun;
using testing::ProgramResult;
using testing::result_in;
using testing::run_with_fault;
using testing::RunningProgram;
using testing::TemporaryFolder;

class Neighbours : public ::testing::Test {
 protected:
  Neighbours() { testing::copy_recording(inputs_.path()); }

  std::vector<std::string> slam() const {
    return testing::slam_command(inputs_.path(), folder_.path(), false);
  }
  std::vector<std::string> study(bool again = false) const {
    auto words = testing::study_command({}, folder_.path(), false);
    if (again) words.emplace_back("--resume");
    return words;
  }

  /// A command under limits of bash's ulimit.
  static ProgramResult limited(const std::string& limits, const std::vector<std::string>& command) {
    std::vector<std::string> words{"/bin/bash", "-c", limits + "; exec \"$@\"", "bash"};
    words.insert(words.end(), command.begin(), command.end());
    return RunningProgram(words).wait();
  }

  static void expect_error(const ProgramResult& result, int exit_code, const std::string& part) {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_TRUE(result.err.starts_with("posemix: error: ")) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }

  TemporaryFolder inputs_;
  TemporaryFolder folder_;
};

TEST_F(Neighbours, ALimitOnTheSizeOfFilesIsAnErrorOfTheOutputAndLeavesNothing) {
  expect_error(limited("ulimit -f 8", slam()), 4, "File too large");
  EXPECT_EQ(testing::names_in(folder_.path()), std::vector<std::string>{});
}

/// From fewer than the loader needs to more than the run does: where the lock of the hidden folder
/// is the last descriptor there is, too.
TEST_F(Neighbours, WithoutDescriptorsNothingIsLeftBehind) {
  std::set<int> codes;
  for (int count = 3; count < 100 && !codes.contains(0); ++count) {
    const ProgramResult result = limited(fmt::format("ulimit -n {}", count), slam());
    codes.insert(result.exit_code);
    if (result.exit_code == 0 || result.exit_code == 127) continue;  // 127 of the loader
    EXPECT_NE(result.err.find("Too many open files"), std::string::npos) << result.err;
    EXPECT_EQ(testing::names_in(folder_.path()), std::vector<std::string>{}) << count;
  }
  EXPECT_TRUE(codes.contains(0)) << "the last limit is enough";
  EXPECT_TRUE(codes.contains(4)) << "one is that of the folder";
}

/// Also where the last descriptor there is would be that of the folder, after the file is replaced.
TEST_F(Neighbours, WithoutDescriptorsAFileIsReplacedOrTheErrorIsTold) {
  run_with_fault(testing::slam_command(inputs_.path(), inputs_.path(), false), "", inputs_.path());
  const fs::path page = folder_ / "page.html";
  const std::vector<std::string> report{POSEMIX_PROGRAM, "report", (inputs_ / "out").string(),
                                        "--quiet",       "--out",  page.string()};
  std::set<int> codes;
  for (int count = 3; count < 100 && !codes.contains(0); ++count) {
    std::ofstream(page) << "before";
    const ProgramResult result = limited(fmt::format("ulimit -n {}", count), report);
    codes.insert(result.exit_code);
    EXPECT_EQ(testing::content_of(page) == "before", result.exit_code != 0) << count << result.err;
    EXPECT_EQ(testing::names_in(folder_.path()), std::vector<std::string>{"page.html"}) << count;
  }
  EXPECT_TRUE(codes.contains(0)) << "the last limit is enough";
  EXPECT_TRUE(codes.contains(4)) << "one is that of the output";
}

/// Its results are there, and the same study can be run again.
TEST_F(Neighbours, AStudyWhoseTableCannotBePrintedIsDone) {
  std::vector<std::string> words = study();
  std::erase(words, "--quiet");
  for (int run = 0; run < 2; ++run) {
    expect_error(limited("exec > /dev/full", words), 4, "standard output: cannot be written");
    EXPECT_EQ(testing::names_in(folder_.path()), std::vector<std::string>{"out"});
  }
}

/// Where relative paths have no beginning.
TEST_F(Neighbours, ACurrentFolderThatIsGoneIsAnError) {
  const std::string gone = (folder_ / "gone").string();
  fs::create_directory(gone);
  std::vector<std::string> words = slam();
  words.back() = "out";
  const ProgramResult result = limited(fmt::format("cd {0}; rmdir {0}", gone), words);
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_NE(result.err.find("out: cannot be created: the current folder is gone"),
            std::string::npos)
      << result.err;
}

/// A loop of links, and a name that is too long.
TEST_F(Neighbours, PathsThatTheSystemRefusesAreNamed) {
  fs::create_symlink(folder_ / "loop", folder_ / "loop");
  for (const std::string& path : {(folder_ / "loop").string(), std::string(300, 'x')}) {
    const ProgramResult result = limited("true", {POSEMIX_PROGRAM, "consistency", path});
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_TRUE(result.err.starts_with("posemix: error: " + path)) << result.err;
  }
}

/// The home of others may often be entered and not read, and a drop box only be written to.
TEST_F(Neighbours, FoldersThatMayNotBeReadAreWrittenTo) {
  std::vector<std::string> as_anybody;
  if (::geteuid() == 0) as_anybody = {"/usr/bin/setpriv", "--reuid=65534", "--clear-groups"};
  const auto run = [&](std::vector<std::string> command) {
    command.insert(command.begin(), as_anybody.begin(), as_anybody.end());
    return RunningProgram(command).wait();
  };
  run_with_fault(testing::slam_command(inputs_.path(), inputs_.path(), false), "", inputs_.path());
  fs::permissions(inputs_.path(), fs::perms(0755));
  const fs::path box = folder_ / "box";
  fs::create_directory(box);
  if (::geteuid() == 0) ASSERT_EQ(::chown(box.c_str(), 65534, 65534), 0);
  fs::permissions(folder_.path(), fs::perms(0711));
  fs::permissions(box, fs::perms(0300));
  const std::string results = (inputs_ / "out").string();
  const std::string page = (box / "page.html").string();
  for (const auto& [way, path] :
       {std::pair{"-x", std::string(POSEMIX_PROGRAM)}, std::pair{"-r", results + "/metrics.json"},
        std::pair{"-w", box.string()}}) {
    if (run({"/usr/bin/test", way, path}).exit_code != 0)
      GTEST_SKIP() << "nobody else may use " << path << " here";
  }
  const ProgramResult one = run({POSEMIX_PROGRAM, "report", results, "--quiet", "--out", page});
  EXPECT_EQ(one.exit_code, 0) << one.err;
  const ProgramResult folder =
      run({POSEMIX_PROGRAM, "simulate", POSEMIX_SOURCE_DIR "/configs/demo.toml", "--quiet", "--out",
           (box / "out").string()});
  EXPECT_EQ(folder.exit_code, 0) << folder.err;
  fs::permissions(box, fs::perms(0700));
  EXPECT_EQ(testing::names_in(box), (std::vector<std::string>{"out", "page.html"}));
}

TEST_F(Neighbours, AStudyWhoseJournalHasNoRoomIsContinued) {
  const FaultyRun whole = run_with_fault(study(), "", folder_.path());
  ASSERT_EQ(whole.result.exit_code, 0) << whole.result.err;
  const auto expected = result_in(folder_.path(), {"out", "study.json"});
  fs::remove_all(folder_ / "out");
  // One block of 1024 bytes holds the head and no more than a part of the items.
  expect_error(limited("ulimit -f 1", study()), 4,
               "out.journal: cannot be written: File too large");
  const ProgramResult again =
      RunningProgram([&] {
        auto words = study(true);
        words.insert(words.begin(), {"/usr/bin/env", "SOURCE_DATE_EPOCH=0"});
        return words;
      }())
          .wait();
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(result_in(folder_.path(), {"out", "study.json"}), expected);
}

TEST_F(Neighbours, WithoutMemoryThereIsAMessageAndNoCore) {
#ifdef POSEMIX_SANITIZED
  GTEST_SKIP() << "sanitizers reserve more than there is";
#endif
  std::set<int> codes;
  // From less than the loader needs to more than the run does.
  for (int kilobytes = 40000; kilobytes < 4000000; kilobytes = kilobytes * 6 / 5) {
    const ProgramResult result = limited(fmt::format("ulimit -v {}", kilobytes), slam());
    codes.insert(result.exit_code);
    if (result.exit_code == 0) break;
    EXPECT_FALSE(fs::exists(folder_ / "out")) << kilobytes;
    if (result.exit_code == 127) continue;  // of the loader
    EXPECT_EQ(result.exit_code, 1) << kilobytes << " kB: " << result.err;
    EXPECT_NE(result.err.find("out of memory"), std::string::npos) << result.err;
  }
  EXPECT_TRUE(codes.contains(0)) << "the last limit is enough";
}

TEST_F(Neighbours, AStudyWithoutRoomForItsThreadsSaysSo) {
#ifdef POSEMIX_SANITIZED
  GTEST_SKIP() << "sanitizers reserve more than there is";
#endif
  auto words = study();
  *(std::find(words.begin(), words.end(), "--threads") + 1) = "2000";
  expect_error(limited("ulimit -v 1500000", words), 1, "out of memory");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Neighbours, NobodyReadsTheOutputAnyMore) {
  const ProgramResult result = RunningProgram({"/bin/bash", "-c", "set -o pipefail; \"$@\" | true",
                                               "bash", POSEMIX_PROGRAM, "data", "list"})
                                   .wait();
  // `true` may end before or after the first write.
  EXPECT_TRUE(result.exit_code == 141 || result.exit_code == 0) << result.exit_code;
  EXPECT_EQ(result.err, "");
}

TEST_F(Neighbours, ASecondProcessOnTheJournalOfARunningStudyIsRefusedWithOrWithoutResume) {
  auto words = study();
  *std::find(words.begin(), words.end(), "runs=5") = "runs=100000";
  RunningProgram first(words);
  const fs::path journal = folder_ / "out.journal";
  while (!fs::exists(journal) || fs::file_size(journal) == 0) {
    ASSERT_FALSE(first.has_ended()) << first.wait().err;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  for (const bool resumes : {false, true}) {
    auto second = words;
    if (resumes) second.emplace_back("--resume");
    expect_error(RunningProgram(second).wait(), 4, "out.journal: in use by another process");
  }
  first.send(SIGINT);
  EXPECT_EQ(first.wait().exit_code, 130);
}

TEST_F(Neighbours, TwoRunsIntoOneFolderLeaveTheFilesOfOne) {
  const auto whole = run_with_fault(slam(), "", folder_.path());
  const auto expected = result_in(folder_.path(), {"out", "metrics.json"});
  for (int i = 0; i < 5; ++i) {
    fs::remove_all(folder_ / "out");
    auto words = slam();
    words.insert(words.begin(), {"/usr/bin/env", "SOURCE_DATE_EPOCH=0"});
    RunningProgram first(words);
    RunningProgram second(words);
    const std::array results{first.wait(), second.wait()};
    for (const ProgramResult& result : results)
      EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 4) << result.err;
    EXPECT_EQ(result_in(folder_.path(), {"out", "metrics.json"}), expected);
    EXPECT_EQ(testing::names_in(folder_.path()), std::vector<std::string>{"out"});
  }
}

// At any moment of a run, as long as one takes, and of those that continue it.
TEST_F(Neighbours, AStudyThatIsKilledAgainAndAgainIsWorthTheSame) {
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run_with_fault(study(), "", folder_.path()).result.exit_code, 0);
  const auto whole = std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::steady_clock::now() - start);
  const auto expected = result_in(folder_.path(), {"out", "study.json"});
  std::mt19937 random(7);
  const int kills = testing::visits_all() ? 1000 : 10;
  int done = 0;
  for (int i = 0; i < kills;) {
    fs::remove_all(folder_ / "out");
    fs::remove(folder_ / "out.journal");
    for (bool ended = false; !ended;) {
      auto words = study(true);
      words.insert(words.begin(), {"/usr/bin/env", "SOURCE_DATE_EPOCH=0"});
      RunningProgram program(words);
      std::uniform_int_distribution<std::int64_t> moment(0, whole.count());
      std::this_thread::sleep_for(std::chrono::microseconds(moment(random)));
      if (i < kills) program.send(SIGKILL);
      const ProgramResult result = program.wait();
      ended = result.exit_code == 0;
      if (!ended) {
        ++i;
        ASSERT_EQ(result.exit_code, 128 + SIGKILL) << result.err;
        const auto now = result_in(folder_.path(), {"out", "study.json"});
        EXPECT_TRUE(!now || now == expected);
      }
    }
    EXPECT_EQ(result_in(folder_.path(), {"out", "study.json"}), expected);
    ++done;
  }
  std::cout << kills << " kills, " << done << " studies\n";
}

#ifdef POSEMIX_MPIRUN
TEST_F(Neighbours, AStudyWhoseRanksAreKilledIsContinued) {
  ASSERT_EQ(run_with_fault(study(), "", folder_.path()).result.exit_code, 0);
  const auto expected = result_in(folder_.path(), {"out", "study.json"});
  const auto ranks = [&](bool again) {
    auto words = study(again);
    words.insert(words.begin(),
                 {"/usr/bin/env", "OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
                  "OMPI_MCA_rmaps_base_oversubscribe=1", POSEMIX_MPIRUN, "-n", "2"});
    return words;
  };
  const FaultyRun counted = run_with_fault(ranks(false), "", folder_.path());
  ASSERT_EQ(counted.result.exit_code, 0) << counted.result.err;
  const std::size_t step = testing::visits_all() ? 1 : counted.calls.size() / 3;
  for (std::size_t point = 2; point < counted.calls.size(); point += step) {
    SCOPED_TRACE(point);
    fs::remove_all(folder_ / "out");
    const FaultyRun run =
        run_with_fault(ranks(false), fmt::format("kill {}", point), folder_.path());
    const auto now = result_in(folder_.path(), {"out", "study.json"});
    EXPECT_TRUE(!now || now == expected);
    if (run.result.exit_code == 0) continue;  // it had fewer calls
    const FaultyRun again = run_with_fault(ranks(true), "", folder_.path());
    EXPECT_EQ(again.result.exit_code, 0) << again.result.err;
    EXPECT_EQ(result_in(folder_.path(), {"out", "study.json"}), expected);
    fs::remove(folder_ / "out.journal");
  }
}
#endif

}  // namespace
}  // namespace posemix
