// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cstdlib>

#include <gtest/gtest.h>

#include "counting_study.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "running_program.hpp"
#include "study/engine/journal.hpp"

/// A study over several processes.
namespace posemix {
namespace {

using testing::counting_study;
using testing::ProgramResult;
using testing::TemporaryFolder;

constexpr std::size_t kRankItems = 200;

class SeveralRanks : public ::testing::TestWithParam<int> {
 protected:
  static void SetUpTestSuite() {
    // Open MPI refuses more ranks than cores, and to run as root, without these.
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
  }

  ProgramResult run(std::vector<std::string> arguments) const {
    std::vector<std::string> command{POSEMIX_MPIRUN, "-n", std::to_string(GetParam()),
                                     POSEMIX_RANKS_PROGRAM, journal_.string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return testing::RunningProgram(command).wait();
  }

  static std::string expected() {
    const Study study = counting_study(kRankItems);
    std::vector<std::string> results;
    for (std::size_t item = 0; item < kRankItems; ++item) results.push_back(study.run_item(item));
    return study.report(results).summary;
  }

  TemporaryFolder folder_;
  std::filesystem::path journal_ = folder_ / "journal";
};

TEST_P(SeveralRanks, GiveWhatOneProcessGives) {
  const ProgramResult result = run({});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, expected());
}

TEST_P(SeveralRanks, LoseNoFinishedItemWhenOneDies) {
  const ProgramResult died = run({"--die-at", "150"});
  EXPECT_NE(died.exit_code, 0);
  {
    const Journal journal(journal_, counting_study(kRankItems), true);
    // Items are handed out in order, at most eight to a rank at a time: items take a millisecond,
    // and chunks are for the 6 ms until the next message and the answer to it.
    EXPECT_GE(journal.finished().size(), 150U - 8U * static_cast<std::size_t>(GetParam()));
    EXPECT_FALSE(journal.finished().contains(150));
  }
  const ProgramResult resumed = run({"--resume"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(resumed.out, expected());
}

TEST_P(SeveralRanks, OfOtherVectorInstructionsAreRefused) {
  if (vector_instructions() == "portable") GTEST_SKIP() << "this machine has no wider set";
  const ProgramResult result =
      testing::RunningProgram({POSEMIX_MPIRUN, "-n", std::to_string(GetParam() - 1),
                               POSEMIX_RANKS_PROGRAM, journal_.string(), ":", "-n", "1",
                               "/usr/bin/env", "POSEMIX_SIMD=portable", POSEMIX_RANKS_PROGRAM,
                               journal_.string()})
          .wait();
  EXPECT_NE(result.exit_code, 0);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(
      result.err.find(fmt::format("rank {} has the vector instructions portable", GetParam() - 1)),
      std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("rank 0 has " + std::string(vector_instructions())), std::string::npos)
      << result.err;
}

INSTANTIATE_TEST_SUITE_P(Two, SeveralRanks, ::testing::Values(2));
INSTANTIATE_TEST_SUITE_P(Four, SeveralRanks, ::testing::Values(4));

}  // namespace
}  // namespace posemix
