// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/small_recording.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "run_program.hpp"

/// What POSEMIX_SIMD does to the program: docs/reproducibility.md.
namespace posemix {
namespace {

using nlohmann::json;
using testing::content_of;
using testing::names_in;
using testing::ProgramResult;
using testing::RunningProgram;
using testing::SmallFolder;
using testing::TemporaryFolder;

/// The program with a value of POSEMIX_SIMD. `before` are words in front of it.
ProgramResult run_with(const std::string& simd, const std::vector<std::string>& arguments,
                       const std::vector<std::string>& before = {}) {
  std::vector<std::string> command{"/usr/bin/env", "-u", "GLIBC_TUNABLES", "POSEMIX_SIMD=" + simd};
  command.insert(command.end(), before.begin(), before.end());
  command.emplace_back(POSEMIX_PROGRAM);
  command.insert(command.end(), arguments.begin(), arguments.end());
  return RunningProgram(command).wait();
}

std::vector<std::string> monte_carlo(const std::filesystem::path& out) {
  return {"study", "monte-carlo", "--set",     "runs=2", "--set",  "methods=[\"midway\"]",
          "--out", out.string(),  "--threads", "1",      "--quiet"};
}

std::string instructions_of(const std::filesystem::path& file) {
  return json::parse(content_of(file)).at("provenance").at("instructions");
}

/// All results of a study, without what depends on command and time.
std::string results_of(const std::filesystem::path& out) {
  std::string text;
  for (const std::string& name : names_in(out)) {
    if (name.starts_with("timing")) continue;
    json study;
    if (name == "study.json") {
      study = json::parse(content_of(out / name));
      for (const char* key : {"command", "finished"}) study.at("provenance").erase(key);
    }
    text += name + "\n" + (study.is_null() ? content_of(out / name) : study.dump());
  }
  return text;
}

/// Numbers agree to a relative 1e-10, and all else is the same.
void expect_close(const json& a, const json& b, const std::string& path) {
  ASSERT_EQ(a.type(), b.type()) << path;
  if (a.is_number_float()) {
    const double x = a.get<double>();
    EXPECT_NEAR(x, b.get<double>(), 1e-10 * std::max(1.0, std::abs(x))) << path;
  } else if (a.is_structured()) {
    ASSERT_EQ(a.size(), b.size()) << path;
    for (auto x = a.begin(), y = b.begin(); x != a.end(); ++x, ++y) {
      const std::string at = a.is_object() ? x.key() : std::to_string(x - a.begin());
      expect_close(*x, *y, path + "/" + at);
    }
  } else {
    EXPECT_EQ(a, b) << path;
  }
}

TEST(Reproducibility, AnUnknownWordIsWrongUsage) {
  const ProgramResult result = run_with("fast", {"--version"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err,
            "posemix: error: POSEMIX_SIMD is \"fast\"; expected auto, portable, avx2, avx512 or "
            "neon\n");
}

TEST(Reproducibility, TheVersionSaysWhatDecidesOnTheLastBits) {
  const ProgramResult automatic = run_with("auto", {"--version"});
  EXPECT_EQ(automatic.exit_code, 0);
  EXPECT_TRUE(automatic.out.ends_with(
      "\nvector instructions: " + std::string(vector_instructions()) + "\n"))
      << automatic.out;
  const ProgramResult portable = run_with("portable", {"--version"});
  EXPECT_EQ(portable.exit_code, 0) << portable.err;
#if defined(__x86_64__)
  EXPECT_TRUE(portable.out.ends_with("\nvector instructions: portable\n")) << portable.out;
#endif
}

TEST(Reproducibility, ThePortableProgramGetsItsOwnWordsWhateverTheyAre) {
  for (const std::string word : {"", " ", "a b", "two\nlines", "--", "-x=\"1\""}) {
    const ProgramResult automatic = run_with("auto", {word, "second"});
    const ProgramResult portable = run_with("portable", {word, "second"});
    EXPECT_EQ(portable.exit_code, automatic.exit_code);
    EXPECT_EQ(portable.err, automatic.err);
    EXPECT_NE(portable.exit_code, 0) << "none of these is a command";
  }
}

#if defined(__x86_64__)
TEST(Reproducibility, ThePortableProgramStartsWithTunablesOfTheUser) {
  for (const std::string tunables :
       {"", "glibc.malloc.check=0", "glibc.cpu.hwcaps=-ERMS", "glibc.cpu.hwcaps=-FMA,-FMA4"}) {
    const ProgramResult result =
        run_with("portable", {"--version"}, {"/usr/bin/env", "GLIBC_TUNABLES=" + tunables});
    EXPECT_EQ(result.exit_code, 0) << tunables << ": " << result.err;
    EXPECT_TRUE(result.out.ends_with("\nvector instructions: portable\n")) << result.out;
  }
}
#endif

TEST(Reproducibility, ThePortableProgramReadsItsStandardInput) {
  const TemporaryFolder folder;
  const auto input = folder.put("mixture.json", "{\"schema\": 1}");
  const auto inspect = [&](const std::string& simd) {
    return RunningProgram({"/bin/sh", "-c",
                           "POSEMIX_SIMD=" + simd + " exec " POSEMIX_PROGRAM " sample - -n 1 <'" +
                               input.string() + "'"})
        .wait();
  };
  EXPECT_EQ(inspect("portable").err, inspect("auto").err);
  EXPECT_EQ(inspect("portable").exit_code, 3);
}

TEST(Reproducibility, PortableResultsAreTheSameBitsOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  for (const std::string threads : {"1", "3"}) {
    std::vector<std::string> arguments = monte_carlo(folder / threads);
    *(arguments.end() - 2) = threads;
    const ProgramResult result = run_with("portable", arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  EXPECT_EQ(results_of(folder / "1"), results_of(folder / "3"));
  EXPECT_EQ(instructions_of(folder / "1" / "study.json"),
            vector_instructions() == "neon" ? "neon" : "portable");
}

TEST(Reproducibility, ResultsSayByWhichVectorInstructionsTheyAre) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_with("auto", monte_carlo(folder / "study")).exit_code, 0);
  EXPECT_EQ(instructions_of(folder / "study" / "study.json"), vector_instructions());
}

TEST(Reproducibility, PortableAndTheWidestSetDifferByRoundingOnly) {
  const SmallFolder small;
  const TemporaryFolder folder;
  json metrics[2];
  const std::string sets[]{"auto", "portable"};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto out = folder / sets[i];
    const ProgramResult result =
        run_with(sets[i], {"slam", small.toml().string(), "--out", out.string(), "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    metrics[i] = json::parse(content_of(out / "metrics.json"));
    for (const char* key : {"timing", "provenance", "run", "files"}) metrics[i].erase(key);
  }
  expect_close(metrics[0], metrics[1], "");
}

#ifdef POSEMIX_MPIRUN
TEST(Reproducibility, PortableRanksGiveWhatOnePortableProcessGives) {
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  ::setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
  const TemporaryFolder folder;
  ASSERT_EQ(run_with("portable", monte_carlo(folder / "one")).exit_code, 0);
  const ProgramResult result =
      run_with("portable", monte_carlo(folder / "many"), {POSEMIX_MPIRUN, "-n", "3"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(results_of(folder / "one"), results_of(folder / "many"));
}
#endif

}  // namespace
}  // namespace posemix
