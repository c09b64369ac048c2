// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <filesystem>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "io/temporary_folder.hpp"
#include "target.hpp"

/// Every input of the corpus once more: the targets keep building and hold.
namespace posemix::fuzzing {

void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

namespace {

std::vector<std::filesystem::path> corpus_of(const Target& target) {
  std::vector<std::filesystem::path> files;
  const std::filesystem::path corpus =
      std::filesystem::path(POSEMIX_SOURCE_DIR) / "tests/fuzz/corpus" / target.name;
  for (const auto& entry : std::filesystem::directory_iterator(corpus))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

class Corpus : public ::testing::TestWithParam<Target> {};

TEST_P(Corpus, IsTakenOrRefusedAsItShouldBe) {
  const std::vector<std::filesystem::path> files = corpus_of(GetParam());
  EXPECT_FALSE(files.empty());
  for (const std::filesystem::path& file : files) {
    EXPECT_NO_THROW(GetParam().feed(posemix::testing::content_of(file))) << file;
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, Corpus, ::testing::ValuesIn(targets()),
                         [](const auto& target) { return target.param.name; });

}  // namespace
}  // namespace posemix::fuzzing
