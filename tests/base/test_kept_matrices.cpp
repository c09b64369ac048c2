// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "base/kept_matrices.hpp"

#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

/// Matrices that a thread keeps. Every test has a thread of its own, which has kept none.
namespace posemix::internal {
namespace {

template <class Test>
void in_a_thread(const Test& test) {
  std::thread(test).join();
}

TEST(KeptMatrices, AreUsedAgain) {
  in_a_thread([] {
    Eigen::MatrixXd matrix = kept_matrix(36);
    ASSERT_EQ(matrix.rows(), 36);
    ASSERT_EQ(matrix.cols(), 36);
    const double* const memory = matrix.data();
    keep(std::move(matrix));
    const Eigen::MatrixXd again = kept_matrix(36);
    EXPECT_EQ(again.data(), memory);
    EXPECT_NE(kept_matrix(36).data(), memory);
  });
}

TEST(KeptMatrices, ACopyHasTheValues) {
  in_a_thread([] {
    keep(Eigen::MatrixXd::Constant(30, 30, 5.0));
    const Eigen::MatrixXd values = Eigen::MatrixXd::Random(30, 30);
    EXPECT_EQ(kept_copy(values), values);
    EXPECT_EQ(kept_copy(Eigen::MatrixXd()).size(), 0);
  });
}

TEST(KeptMatrices, HaveTheSizeThatIsAskedFor) {
  in_a_thread([] {
    keep(Eigen::MatrixXd(36, 36));
    EXPECT_EQ(kept_matrix(42).rows(), 42);
    keep(Eigen::MatrixXd(42, 42));
    EXPECT_EQ(kept_matrix(36).rows(), 36);
    EXPECT_EQ(kept_matrix(0).size(), 0);
    // Of any shape, and with nothing left in it.
    keep(Eigen::MatrixXd(36, 30));
    keep(Eigen::MatrixXd());
    EXPECT_EQ(kept_matrix(36).cols(), 36);
  });
}

TEST(KeptMatrices, AreBounded) {
  in_a_thread([] {
    constexpr Eigen::Index kSize = 512;  // of 2 MB
    std::vector<Eigen::MatrixXd> matrices(8, Eigen::MatrixXd::Zero(kSize, kSize));
    std::vector<const double*> memory;
    for (Eigen::MatrixXd& matrix : matrices) {
      memory.push_back(matrix.data());
      keep(std::move(matrix));
    }
    // The first four of them come back, the last first.
    for (std::size_t i = 4; i-- > 0;) {
      matrices[i] = kept_matrix(kSize);
      EXPECT_EQ(matrices[i].data(), memory[i]);
    }
  });
}

}  // namespace
}  // namespace posemix::internal
