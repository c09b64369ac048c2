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
#include "io/temporary_folder.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/io/text.hpp"
#include "study/engine/journal.hpp"

namespace posemix {
namespace {

using testing::counting_study;
using testing::TemporaryFolder;

constexpr std::size_t kItems = 60;

std::vector<std::string> expected_results() {
  const Study study = counting_study(kItems);
  std::vector<std::string> results;
  for (std::size_t item = 0; item < kItems; ++item) results.push_back(study.run_item(item));
  return results;
}

StudyRun run_here(const std::function<Study()>& make, const StudyRunOptions& options) {
  Ranks ranks;
  return run_study(ranks, make, options).value();
}

/// The message of the InvalidInput that `action` throws.
template <class Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(RunStudy, GivesTheSameForAnyNumberOfThreads) {
  const auto expected = expected_results();
  for (const std::size_t threads : {1, 2, 5}) {
    const StudyRun run = run_here([] { return counting_study(kItems); }, {.threads = threads});
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
    Study study = counting_study(kItems);
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
  EXPECT_EQ(calls, kItems) << "what had begun when the study was stopped is kept too";
  EXPECT_GE(first_report, 20U);
}

TEST(RunStudy, AnItemThatThrowsEndsTheStudyAndKeepsWhatIsDone) {
  const TemporaryFolder folder;
  const StudyRunOptions options{.threads = 2, .journal = folder / "journal"};
  const auto make = [] {
    Study study = counting_study(kItems);
    study.run_item = [work = study.run_item](std::size_t item) {
      if (item == 30) throw std::runtime_error("item 30 is broken");
      return work(item);
    };
    return study;
  };
  Ranks ranks;
  EXPECT_THROW(run_study(ranks, make, options), std::runtime_error);
  const Journal journal(options.journal, counting_study(kItems), true);
  EXPECT_GE(journal.finished().size(), 29U);
  EXPECT_FALSE(journal.finished().contains(30));
}

class JournalFile : public ::testing::Test {
 protected:
  void fill(std::size_t items) {
    Journal journal(path_, study_, false);
    std::vector<FinishedItem> finished;
    for (std::size_t item = 0; item < items; ++item)
      finished.push_back({item, fmt::format("result \"{}\"", item)});
    journal.append(finished);
  }

  /// Puts something else in the place of the vector instructions, with their key.
  void replace_instructions(const std::string& by) {
    const std::string key = fmt::format(R"(,"instructions":"{}")", vector_instructions());
    std::string text = read_file(path_);
    const std::size_t at = text.find(key);
    ASSERT_LT(at, text.find('\n')) << text;
    std::ofstream(path_, std::ios::binary) << text.replace(at, key.size(), by);
  }

  std::size_t count() { return Journal(path_, study_, true).finished().size(); }

  std::size_t count_lines() {
    const std::string text = read_file(path_);
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "journal";
  Study study_ = counting_study(kItems);
};

TEST_F(JournalFile, IsReadBack) {
  fill(3);
  const Journal journal(path_, study_, true);
  ASSERT_EQ(journal.finished().size(), 3U);
  EXPECT_EQ(journal.finished().at(2), "result \"2\"");
}

TEST_F(JournalFile, IsNotOverwrittenWithoutResume) {
  fill(3);
  const std::string message = refusal([&] { Journal(path_, study_, false); });
  EXPECT_NE(message.find("--resume"), std::string::npos) << message;
  EXPECT_EQ(count(), 3U);
}

TEST_F(JournalFile, StartsAfreshWithResumeWhereThereIsNone) { EXPECT_EQ(count(), 0U); }

TEST_F(JournalFile, IsNotLeftBehindWithoutAFinishedItem) {
  fill(0);
  EXPECT_FALSE(std::filesystem::exists(path_));
  fill(1);
  EXPECT_TRUE(std::filesystem::exists(path_));
}

TEST_F(JournalFile, IgnoresALastLineThatWasCutOff) {
  fill(3);
  const std::string whole = read_file(path_);
  for (std::size_t cut = 1; cut < 20; ++cut) {
    std::ofstream(path_, std::ios::binary) << whole.substr(0, whole.size() - cut);
    EXPECT_EQ(count(), 2U) << cut;
    EXPECT_EQ(count(), 2U) << "what is appended later starts a line of its own";
  }
}

TEST_F(JournalFile, SurvivesACutWithinItsHead) {
  fill(3);
  std::ofstream(path_, std::ios::binary) << read_file(path_).substr(0, 10);
  EXPECT_EQ(count(), 0U);
}

TEST_F(JournalFile, RefusesALineThatIsDamaged) {
  fill(3);
  std::string text = read_file(path_);
  text[text.find("item\":1") + 2] = '#';
  std::ofstream(path_, std::ios::binary) << text;
  const std::string message = refusal([&] { count(); });
  EXPECT_NE(message.find("journal:3:"), std::string::npos) << message;
}

TEST_F(JournalFile, RefusesOtherSettingsAndSaysWhich) {
  fill(1);
  const std::string message = refusal([&] { Journal(path_, counting_study(kItems, 2), true); });
  EXPECT_NE(message.find("'settings.seed' is 1, now 2"), std::string::npos) << message;
}

TEST_F(JournalFile, SaysByWhichVectorInstructionsItsItemsAre) {
  fill(1);
  EXPECT_EQ(Journal(path_, study_, true).instructions(), vector_instructions());
}

TEST_F(JournalFile, RefusesResultsByOtherVectorInstructions) {
  fill(2);
  replace_instructions(R"(,"instructions":"avx1024")");
  const std::string message = refusal([&] { count(); });
  EXPECT_NE(message.find("by other vector instructions, avx1024, now " +
                         std::string(vector_instructions())),
            std::string::npos)
      << message;
  EXPECT_EQ(count_lines(), 3U) << "nothing is lost";
}

TEST_F(JournalFile, OfAProgramThatDidNotSayIsContinuedWithoutAWordOnInstructions) {
  fill(2);
  replace_instructions("");
  const Journal journal(path_, study_, true);
  EXPECT_EQ(journal.finished().size(), 2U);
  EXPECT_EQ(journal.instructions(), "");
}

TEST_F(JournalFile, RefusesInstructionsThatAreNoText) {
  fill(2);
  replace_instructions(R"(,"instructions":512)");
  const std::string message = refusal([&] { count(); });
  EXPECT_NE(message.find("journal:1:"), std::string::npos) << message;
  EXPECT_NE(message.find("512"), std::string::npos) << message;
}

TEST_F(JournalFile, IsLockedAgainstASecondProcess) {
  const Journal journal(path_, study_, false);
  EXPECT_THROW(Journal(path_, study_, true), OutputError);
}

TEST_F(JournalFile, NamesAFolderThatIsMissing) {
  EXPECT_THROW(Journal(folder_ / "missing" / "journal", study_, false), OutputError);
}

}  // namespace
}  // namespace posemix
