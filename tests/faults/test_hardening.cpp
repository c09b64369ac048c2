// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// What the linker and the compiler have put into the program, as readelf says.
#include <string>

#include <gtest/gtest.h>

#include "app/run_program.hpp"

namespace posemix {
namespace {

std::string read_elf(const std::string& what) {
  const auto result =
      testing::RunningProgram({POSEMIX_READELF, "--wide", what, POSEMIX_PROGRAM}).wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.out;
}

/// The line of a text that has the word.
std::string line_with(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  if (at == std::string::npos) return "";
  const std::size_t begin = text.rfind('\n', at) + 1;
  return text.substr(begin, text.find('\n', at) - begin);
}

class Hardening : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::string(POSEMIX_READELF).find("NOTFOUND") != std::string::npos)
      GTEST_SKIP() << "there is no readelf";
#ifndef POSEMIX_HARDENED
    GTEST_SKIP() << "this build is without (POSEMIX_HARDEN=OFF)";
#endif
  }
};

TEST_F(Hardening, TheProgramIsPositionIndependent) {
  EXPECT_NE(line_with(read_elf("--file-header"), "Type:").find("DYN"), std::string::npos);
  EXPECT_NE(line_with(read_elf("--dynamic"), "(FLAGS_1)").find("PIE"), std::string::npos);
}

TEST_F(Hardening, TablesOfTheLinkerAreFilledAtTheStartAndReadOnlyThen) {
  EXPECT_NE(line_with(read_elf("--program-headers"), "GNU_RELRO"), "");
  EXPECT_NE(line_with(read_elf("--dynamic"), "(FLAGS_1)").find("NOW"), std::string::npos);
}

TEST_F(Hardening, NoSegmentIsWritableAndExecutable) {
  const std::string headers = read_elf("--program-headers");
  const std::string stack = line_with(headers, "GNU_STACK");
  EXPECT_NE(stack.find(" RW "), std::string::npos) << stack;
  EXPECT_EQ(headers.find(" RWE "), std::string::npos) << headers;
}

TEST_F(Hardening, TheStackIsGuardedAndFunctionsOfGlibcAreChecked) {
#ifdef POSEMIX_SANITIZED
  GTEST_SKIP() << "sanitizers have checks of their own";
#endif
  const std::string symbols = read_elf("--dyn-syms");
  EXPECT_NE(line_with(symbols, "__stack_chk_fail"), "");
  EXPECT_NE(line_with(symbols, "_chk@GLIBC"), "") << "_FORTIFY_SOURCE";
}

}  // namespace
}  // namespace posemix
