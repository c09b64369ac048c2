// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/vector_instructions.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "base/dense_kernels.hpp"
#include "base/every_instruction_set.hpp"
#include "posemix/base/error.hpp"

/// What POSEMIX_SIMD chooses. A process reads it once, so every case has a process of its own.
namespace posemix {
namespace {

constexpr double kX = 1.0 + 0x1p-30;

/// -(x x) + x x as an inner loop evaluates it, in rows for the widest vectors. The product x x is
/// not a double: a fused multiply-add leaves what rounding takes from it, others leave zero. The
/// loop sums even columns apart from odd ones.
double residue_of_inner_loops() {
  constexpr Eigen::Index kRows = 16;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(kRows, 3);
  a.col(0).setConstant(-(kX * kX));
  a.col(2).setConstant(kX);
  Eigen::VectorXd y;
  internal::set_product(y, a, Eigen::Vector3d(1.0, 0.0, kX));
  return y.cwiseAbs().maxCoeff();
}

/// Ends this process: 0 when the set has the name and its loops fuse or not, as they should.
[[noreturn]] void exit_with(const char* variable, const std::string& set, bool fuses) {
  ::setenv("POSEMIX_SIMD", variable, 1);
  const double residue = residue_of_inner_loops();
  const double expected = fuses ? std::fma(kX, kX, -(kX * kX)) : 0.0;
  const bool named = vector_instructions().substr(0, vector_instructions().find(' ')) == set;
  std::_Exit((named ? 0 : 1) + (residue == expected ? 0 : 2));
}

/// Ends this process: 3, with the message, when the word is refused.
[[noreturn]] void exit_refused(const char* variable) {
  ::setenv("POSEMIX_SIMD", variable, 1);
  try {
    vector_instructions();
  } catch (const InvalidInput& error) {
    std::fputs(error.what(), stderr);
    std::_Exit(3);
  }
  std::_Exit(0);
}

bool has(std::int64_t target) { return (hwy::SupportedTargets() & target) != 0; }

class VectorInstructions : public ::testing::Test {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }

  /// The set that the machine chooses by itself.
  static const char* widest() { return has(HWY_AVX3) ? "avx512" : "avx2"; }
};

TEST_F(VectorInstructions, TheResidueOfAFusedProductIsNotZero) {
  EXPECT_EQ(std::fma(kX, kX, -(kX * kX)), 0x1p-60);
}

#if defined(__x86_64__)
TEST_F(VectorInstructions, PortableLoopsDoNotFuse) {
  EXPECT_EXIT(exit_with("portable", "portable", false), ::testing::ExitedWithCode(0), "");
}

TEST_F(VectorInstructions, AnEmptyWordAndAutoAreTheWidestSet) {
  if (!has(HWY_AVX2)) GTEST_SKIP() << "the machine has no AVX2";
  for (const char* word : {"", "auto"})
    EXPECT_EXIT(exit_with(word, widest(), true), ::testing::ExitedWithCode(0), "") << word;
}

TEST_F(VectorInstructions, ANarrowerSetCanBeNamed) {
  if (!has(HWY_AVX2)) GTEST_SKIP() << "the machine has no AVX2";
  EXPECT_EXIT(exit_with("avx2", "avx2", true), ::testing::ExitedWithCode(0), "");
}

TEST_F(VectorInstructions, ASetThatTheMachineLacksIsRefused) {
  EXPECT_EXIT(exit_refused("neon"), ::testing::ExitedWithCode(3),
              "POSEMIX_SIMD is \"neon\", which this machine does not have");
}
#endif

TEST_F(VectorInstructions, AnUnknownWordIsRefusedAndNamed) {
  EXPECT_EXIT(exit_refused("fast"), ::testing::ExitedWithCode(3),
              "POSEMIX_SIMD is \"fast\"; expected auto, portable, avx2, avx512 or neon");
}

}  // namespace
}  // namespace posemix
