// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "io/temporary_folder.hpp"
#include "mutations.hpp"
#include "target.hpp"

/// Every input of the corpus once more, and some that differ from it: the targets keep building and
/// hold.
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

/// A number of the environment.
std::uint64_t number_of(const char* name, std::uint64_t otherwise) {
  const char* const given = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): no other thread
  return given == nullptr ? otherwise : std::stoull(given);
}

// No coverage leads them, and no sanitizer slows them down: POSEMIX_FUZZ_MUTATIONS of
// POSEMIX_FUZZ_SEED. An input that breaks the target is kept in the working folder.
TEST_P(Corpus, HoldsWithAFewBytesChanged) {
  std::vector<std::string> corpus;
  for (const std::filesystem::path& file : corpus_of(GetParam()))
    corpus.push_back(posemix::testing::content_of(file));
  const std::uint64_t seed = number_of("POSEMIX_FUZZ_SEED", 1);
  Mutations mutations(std::move(corpus), seed);
  for (std::uint64_t k = number_of("POSEMIX_FUZZ_MUTATIONS", 2000); k > 0; --k) {
    const std::string bytes = mutations.next();
    try {
      GetParam().feed(bytes);
      mutations.keep(bytes);
    } catch (const Broken& broken) {
      const std::string name = fmt::format("broken-{}-{}-{}", GetParam().name, seed, k);
      std::ofstream(name, std::ios::binary) << bytes;
      ADD_FAILURE() << name << ": " << broken.what();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, Corpus, ::testing::ValuesIn(targets()),
                         [](const auto& target) { return target.param.name; });

}  // namespace
}  // namespace posemix::fuzzing
