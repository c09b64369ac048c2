// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/engine/journal.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <regex>
#include <utility>

#include <sys/resource.h>

#include <gtest/gtest.h>

#include "counting_study.hpp"
#include "io/expect_invalid.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using testing::counting_study;
using testing::invalid_input_message;
using testing::TemporaryFolder;

constexpr std::size_t kJournalItems = 60;

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
  Study study_ = counting_study(kJournalItems);
};

TEST_F(JournalFile, IsReadBack) {
  fill(3);
  const Journal journal(path_, study_, true);
  ASSERT_EQ(journal.finished().size(), 3U);
  EXPECT_EQ(journal.finished().at(2), "result \"2\"");
}

TEST_F(JournalFile, IsNotOverwrittenWithoutResume) {
  fill(3);
  const std::string message = invalid_input_message([&] { Journal(path_, study_, false); });
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
  const std::string message = invalid_input_message([&] { count(); });
  EXPECT_NE(message.find("journal:3:"), std::string::npos) << message;
}

TEST_F(JournalFile, RefusesAResultThatIsDamagedThoughItsLineIsWhole) {
  fill(3);
  const std::string text = read_file(path_);
  const std::size_t begin = text.find("result \\\"1");
  for (const auto& [at, by] :
       {std::pair{begin, 'R'}, {begin + 9, '7'}, {text.find("\"item\":1") + 7, '4'}}) {
    ASSERT_NE(text[at], by);
    std::string damaged = text;
    damaged[at] = by;
    std::ofstream(path_, std::ios::binary) << damaged;
    const std::string message = invalid_input_message([&] { count(); });
    EXPECT_NE(message.find("journal:3:"), std::string::npos) << message;
    EXPECT_NE(message.find("without this line the item is done again"), std::string::npos)
        << message;
  }
  const std::size_t line = text.rfind('\n', begin) + 1;
  std::ofstream(path_, std::ios::binary)
      << text.substr(0, line) + text.substr(text.find('\n', line) + 1);
  EXPECT_EQ(count(), 2U) << "as the message says";
}

TEST_F(JournalFile, OfAProgramWithoutChecksumsIsContinuedWithoutThem) {
  fill(2);
  std::string text =
      std::regex_replace(read_file(path_), std::regex(R"(,"crc64":("\w*"|true))"), "");
  ASSERT_EQ(text.find("crc64"), std::string::npos);
  std::ofstream(path_, std::ios::binary) << text;
  {
    Journal journal(path_, study_, true);
    EXPECT_EQ(journal.finished().size(), 2U);
    journal.append(std::vector<FinishedItem>{{2, "more"}});
  }
  EXPECT_EQ(read_file(path_).find("crc64"), std::string::npos)
      << "an earlier program reads it, too";
  EXPECT_EQ(count(), 3U);
}

TEST_F(JournalFile, AFullDiskLeavesWholeLinesAndWhatComesNextBeginsItsOwn) {
  std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit before {};
  getrlimit(RLIMIT_FSIZE, &before);
  for (std::size_t room = 0; room < 45; room += 4) {
    std::filesystem::remove(path_);
    Journal journal(path_, study_, false);
    journal.append(std::vector<FinishedItem>{{0, "first"}});
    struct rlimit full = before;
    full.rlim_cur = std::filesystem::file_size(path_) + room;
    setrlimit(RLIMIT_FSIZE, &full);
    EXPECT_THROW(journal.append(std::vector<FinishedItem>{{1, "has no room"}}), OutputError);
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_TRUE(read_file(path_).ends_with('\n')) << room;
    journal.append(std::vector<FinishedItem>{{2, "has room"}});
    EXPECT_EQ(count_lines(), 3U) << room;
  }
  EXPECT_EQ(count(), 2U);
}

TEST_F(JournalFile, WithoutItemsIsNoReasonToRefuseAStudy) {
  fill(1);
  const std::string text = read_file(path_);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{5}, text.find('\n'), text.find('\n') + 1}) {
    std::ofstream(path_, std::ios::binary) << text.substr(0, size);
    EXPECT_NO_THROW(Journal(path_, study_, false)) << size;
  }
}

TEST_F(JournalFile, DoesNotTouchAFileThatIsNone) {
  for (const std::string text : {"notes", "notes\n", "notes\nmore\n"}) {
    std::ofstream(path_, std::ios::binary) << text;
    for (const bool resume : {false, true}) {
      const std::string message = invalid_input_message([&] { Journal(path_, study_, resume); });
      EXPECT_NE(message.find("journal:1: got \"notes\", expected the head of a study's journal"),
                std::string::npos)
          << message;
      EXPECT_EQ(message.find("remove"), std::string::npos) << message;
    }
    EXPECT_EQ(read_file(path_), text);
  }
}

TEST_F(JournalFile, RefusesOtherSettingsAndSaysWhich) {
  fill(1);
  const std::string message =
      invalid_input_message([&] { Journal(path_, counting_study(kJournalItems, 2), true); });
  EXPECT_NE(message.find("'settings.seed' is 1, now 2"), std::string::npos) << message;
}

TEST_F(JournalFile, SaysByWhichVectorInstructionsItsItemsAre) {
  fill(1);
  EXPECT_EQ(Journal(path_, study_, true).instructions(), vector_instructions());
}

TEST_F(JournalFile, RefusesResultsByOtherVectorInstructions) {
  fill(2);
  replace_instructions(R"(,"instructions":"avx1024")");
  const std::string message = invalid_input_message([&] { count(); });
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
  const std::string message = invalid_input_message([&] { count(); });
  EXPECT_NE(message.find("journal:1:"), std::string::npos) << message;
  EXPECT_NE(message.find("512"), std::string::npos) << message;
}

TEST_F(JournalFile, IsLockedAgainstASecondProcess) {
  const Journal journal(path_, study_, false);
  EXPECT_THROW(Journal(path_, study_, false), OutputError) << "and not called an interrupted one";
  EXPECT_THROW(Journal(path_, study_, true), OutputError);
}

TEST_F(JournalFile, NamesAFolderThatIsMissing) {
  EXPECT_THROW(Journal(folder_ / "missing" / "journal", study_, false), OutputError);
}

}  // namespace
}  // namespace posemix
