// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/engine/run_study.hpp"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "counting_study.hpp"
#include "io/expect_invalid.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/io/text.hpp"
#include "study/engine/journal.hpp"

namespace posemix {
namespace {

using testing::counting_study;
using testing::invalid_input_message;
using testing::TemporaryFolder;

constexpr std::size_t kStudyItems = 60;

std::vector<std::string> expected_results() {
  const Study study = counting_study(kStudyItems);
  std::vector<std::string> results;
  for (std::size_t item = 0; item < kStudyItems; ++item) results.push_back(study.run_item(item));
  return results;
}

StudyRun run_here(const std::function<Study()>& make, const StudyRunOptions& options) {
  Ranks ranks;
  return run_study(ranks, make, options).value();
}

TEST(RunStudy, GivesTheSameForAnyNumberOfThreads) {
  const auto expected = expected_results();
  for (const std::size_t threads : {1, 2, 5}) {
    const StudyRun run = run_here([] { return counting_study(kStudyItems); }, {.threads = threads});
    EXPECT_TRUE(run.complete);
    EXPECT_EQ(run.results, expected) << threads << " threads";
    EXPECT_EQ(run.instructions, vector_instructions());
  }
}

TEST(RunStudy, ContinuesAStoppedStudyWithoutDoingAnythingTwice) {
  const TemporaryFolder folder;
  StudyRunOptions options{.threads = 2, .journal = folder / "journal"};
  options.progress = [](std::size_t done, std::size_t) { return done < 20; };
  std::atomic<std::size_t> calls = 0;
  const auto make = [&calls] {
    Study study = counting_study(kStudyItems);
    study.run_item = [&calls, work = study.run_item](std::size_t item) {
      ++calls;
      return work(item);
    };
    return study;
  };
  const StudyRun stopped = run_here(make, options);
  EXPECT_FALSE(stopped.complete);
  EXPECT_GE(calls, 20U);
  EXPECT_LT(calls, 40U);

  std::size_t first_report = 0;
  options.resume = true;
  options.progress = [&](std::size_t done, std::size_t) {
    if (first_report == 0) first_report = done;
    return true;
  };
  const StudyRun run = run_here(make, options);
  EXPECT_TRUE(run.complete);
  EXPECT_EQ(run.results, expected_results());
  EXPECT_EQ(calls, kStudyItems) << "what had begun when the study was stopped is kept too";
  EXPECT_GE(first_report, 20U);
}

TEST(RunStudy, AnItemThatThrowsEndsTheStudyAndKeepsWhatIsDone) {
  const TemporaryFolder folder;
  const StudyRunOptions options{.threads = 2, .journal = folder / "journal"};
  const auto make = [] {
    Study study = counting_study(kStudyItems);
    study.run_item = [work = study.run_item](std::size_t item) {
      if (item == 30) throw std::runtime_error("item 30 is broken");
      return work(item);
    };
    return study;
  };
  Ranks ranks;
  EXPECT_THROW(run_study(ranks, make, options), std::runtime_error);
  const Journal journal(options.journal, counting_study(kStudyItems), true);
  EXPECT_GE(journal.finished().size(), 29U);
  EXPECT_FALSE(journal.finished().contains(30));
}

}  // namespace
}  // namespace posemix
