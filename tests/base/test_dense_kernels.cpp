// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "base/dense_kernels.hpp"

#include <cstdint>
#include <limits>
#include <stdexcept>

#include <sys/mman.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "posemix/base/random.hpp"

// Oracle: the same in long double, by definition and without blocks.
namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

MatrixXd random_matrix(Index rows, Index columns, std::uint64_t seed) {
  RandomStream stream(11, seed);
  MatrixXd m(rows, columns);
  for (double& x : m.reshaped()) x = stream.normal();
  return m;
}

/// Of condition number about `spread`^2.
MatrixXd random_covariance(Index n, double spread, std::uint64_t seed) {
  const MatrixXd root = random_matrix(n, n, seed);
  MatrixXd s = root * root.transpose() / static_cast<double>(n) + MatrixXd::Identity(n, n);
  for (Index i = 0; i < n; ++i) {
    const double scale = i % 2 == 0 ? spread : 1.0;
    s.row(i) *= scale;
    s.col(i) *= scale;
  }
  return s;
}

/// The largest entry of the difference over the largest of the expected values.
double relative_error(const MatrixXd& values, const MatrixXl& expected) {
  return static_cast<double>((values.cast<long double>() - expected).cwiseAbs().maxCoeff() /
                             expected.cwiseAbs().maxCoeff());
}

constexpr double kTolerance = 1e-13;
constexpr Index kSizes[] = {6, 12, 18, 24, 30, 36, 42, 66, 126};

TEST(DenseKernels, AProductIsSubtracted) {
  by_every_instruction_set([] {
    for (const Index rows : kSizes) {
      for (const Index depth : {1, 6, 17, 36}) {
        const MatrixXd a = random_matrix(rows, depth, 1);
        const MatrixXd b = random_matrix(18, depth, 2);
        MatrixXd c = random_matrix(rows, 18, 3);
        const MatrixXl expected =
            c.cast<long double>() - a.cast<long double>() * b.cast<long double>().transpose();
        subtract_product(c, a, b);
        EXPECT_LT(relative_error(c, expected), kTolerance) << rows << " rows, depth " << depth;
      }
    }
  });
}

TEST(DenseKernels, ABlockIsChangedAndNothingAroundIt) {
  by_every_instruction_set([] {
    const MatrixXd a = random_matrix(18, 6, 1);
    MatrixXd c = random_matrix(32, 32, 3);
    MatrixXd expected = c;
    expected.block(7, 9, 18, 18) -= a * a.transpose();
    subtract_product(c.block(7, 9, 18, 18), a, a);
    EXPECT_LT(relative_error(c, expected.cast<long double>()), kTolerance);
    expected.block(7, 9, 18, 18).setZero();
    c.block(7, 9, 18, 18).setZero();
    EXPECT_EQ(c, expected);
  });
}

TEST(DenseKernels, ASymmetricProductIsThatAboveTheDiagonalAndExactlySymmetric) {
  by_every_instruction_set([] {
    for (const Index n : kSizes) {
      // Not symmetric, to see which triangle is computed.
      const MatrixXd a = random_matrix(n, 6, 4);
      const MatrixXd b = random_matrix(n, 6, 5);
      MatrixXd p = random_covariance(n, 1.0, 6);
      MatrixXl expected =
          p.cast<long double>() - a.cast<long double>() * b.cast<long double>().transpose();
      expected = expected.triangularView<Eigen::Upper>();
      expected += MatrixXl(expected.triangularView<Eigen::StrictlyUpper>().transpose());
      MatrixXd result = MatrixXd::Constant(n, n, std::numeric_limits<double>::quiet_NaN());
      set_symmetric_difference(result, p, a, b);
      subtract_symmetric_product(p, a, b);
      EXPECT_LT(relative_error(p, expected), kTolerance) << n;
      EXPECT_EQ(p, p.transpose()) << n;
      EXPECT_EQ(result, p) << n;
    }
  });
}

TEST(DenseKernels, TheFactorIsCholeskys) {
  by_every_instruction_set([] {
    for (const Index n : kSizes) {
      const MatrixXd s = random_covariance(n, 10.0, 7);
      MatrixXd l = s;
      // What stands above the diagonal is not read.
      l.triangularView<Eigen::StrictlyUpper>().setConstant(
          std::numeric_limits<double>::quiet_NaN());
      ASSERT_TRUE(factor_in_place(l)) << n;
      const MatrixXd lower = l.triangularView<Eigen::Lower>();
      const MatrixXl expected = s.cast<long double>().llt().matrixL();
      EXPECT_LT(relative_error(lower, expected), kTolerance) << n;
    }
  });
}

TEST(DenseKernels, AMatrixThatIsNotPositiveDefiniteHasNoFactor) {
  by_every_instruction_set([] {
    for (const Index bad : {0, 5, 6, 17, 23}) {
      MatrixXd s = random_covariance(24, 1.0, 8);
      s(bad, bad) = -1e-6;
      EXPECT_FALSE(factor_in_place(s)) << bad;
      s = random_covariance(24, 1.0, 8);
      s(bad, bad) = std::numeric_limits<double>::quiet_NaN();
      EXPECT_FALSE(factor_in_place(s)) << bad;
    }
  });
}

TEST(DenseKernels, SolutionsFromTheRight) {
  by_every_instruction_set([] {
    for (const Index n : kSizes) {
      for (const Index rows : {6, 18, 36}) {
        const MatrixXd s = random_covariance(n, 3.0, 9);
        const MatrixXd x = random_matrix(rows, n, 10);
        const Eigen::LLT<MatrixXl> exact(s.cast<long double>());
        MatrixXd l = s;
        ASSERT_TRUE(factor_in_place(l));
        MatrixXd half = x;
        solve_transposed_from_right(l, half);
        const MatrixXl x_t = x.cast<long double>().transpose();
        EXPECT_LT(relative_error(half, exact.matrixL().solve(x_t).transpose()), kTolerance) << n;
        MatrixXd whole = x;
        solve_from_right(l, whole);
        EXPECT_LT(relative_error(whole, exact.solve(x_t).transpose()), kTolerance) << n;
      }
    }
  });
}

TEST(DenseKernels, AnyNumberOfRowsIsSolvedFor) {
  by_every_instruction_set([] {
    const MatrixXd s = random_covariance(18, 3.0, 9);
    MatrixXd l = s;
    ASSERT_TRUE(factor_in_place(l));
    for (const Index rows : {1, 2, 5, 7, 9, 13, 37}) {
      const MatrixXd x = random_matrix(rows, 18, 10);
      MatrixXd found = x;
      solve_from_right(l, found);
      const MatrixXl x_t = x.cast<long double>().transpose();
      const MatrixXl expected = s.cast<long double>().llt().solve(x_t).transpose();
      EXPECT_LT(relative_error(found, expected), kTolerance) << rows;
    }
  });
}

TEST(DenseKernels, DifferencesProductsWithVectorsAndDeterminants) {
  by_every_instruction_set([] {
    for (const Index rows : {1, 6, 7, 36}) {
      const MatrixXd a = random_matrix(rows, 9, 13);
      const MatrixXd b = random_matrix(rows, 9, 14);
      MatrixXd c(rows, 9);
      set_difference(c, a, b);
      EXPECT_EQ(c, a - b) << rows;
      const Eigen::VectorXd x = random_matrix(9, 1, 15);
      const MatrixXl expected = a.cast<long double>() * x.cast<long double>();
      Eigen::VectorXd y;
      set_product(y, a, x);
      EXPECT_LT(relative_error(y, expected), kTolerance) << rows;
    }
    for (const double scale : {1e-30, 1.0, 1e30}) {
      MatrixXd s = scale * random_covariance(36, 3.0, 16);
      const MatrixXl l = s.cast<long double>().llt().matrixL();
      const long double expected = 2.0L * l.diagonal().array().log().sum();
      ASSERT_TRUE(factor_in_place(s));
      EXPECT_NEAR(log_det_of_factor(s), static_cast<double>(expected), 1e-11) << scale;
    }
  });
}

/// Memory that ends where none may be read or written.
class MemoryBeforeNothing {
 public:
  MemoryBeforeNothing() {
    begin_ = ::mmap(nullptr, 2 * page_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (begin_ == MAP_FAILED || ::mprotect(end(), page_, PROT_NONE) != 0)
      throw std::runtime_error("no memory for the test");
  }
  ~MemoryBeforeNothing() { ::munmap(begin_, 2 * page_); }
  MemoryBeforeNothing(const MemoryBeforeNothing&) = delete;
  MemoryBeforeNothing& operator=(const MemoryBeforeNothing&) = delete;

  /// A matrix whose last entry is the last before the end.
  Eigen::Map<MatrixXd> copy_of(const MatrixXd& m) const {
    double* const first = reinterpret_cast<double*>(end()) - m.size();
    Eigen::Map<MatrixXd> map(first, m.rows(), m.cols());
    map = m;
    return map;
  }

 private:
  char* end() const { return static_cast<char*>(begin_) + page_; }

  std::size_t page_ = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  void* begin_ = nullptr;
};

/// Vectors of two lanes read the number behind a matrix of an odd number of rows.
TEST(DenseKernels, NothingBehindAMatrixIsRead) {
  by_every_instruction_set([] {
    const MemoryBeforeNothing left, right, found;
    for (const Index rows : {1, 3, 5, 7, 13}) {
      const MatrixXd a = random_matrix(rows, 6, 17);
      const MatrixXd b = random_matrix(rows, 6, 18);
      auto c = found.copy_of(a);
      set_difference(c, left.copy_of(a), right.copy_of(b));
      EXPECT_EQ(c, a - b) << rows;
      const Eigen::VectorXd x = random_matrix(6, 1, 19);
      Eigen::VectorXd y;
      set_product(y, left.copy_of(a), x);
      EXPECT_LT((y - a * x).norm(), 1e-12) << rows;
      const MatrixXd s = random_covariance(6, 3.0, 20);
      MatrixXd l = s;
      ASSERT_TRUE(factor_in_place(l));
      auto solved = found.copy_of(a);
      solve_from_right(right.copy_of(l), solved);
      EXPECT_LT((solved * s - a).norm(), 1e-12) << rows;
    }
  });
}

TEST(DenseKernels, TheLowerTriangleIsMirrored) {
  by_every_instruction_set([] {
    for (const Index n : kSizes) {
      MatrixXd m = random_matrix(n, n, 12);
      MatrixXd expected = m.triangularView<Eigen::Lower>();
      expected.triangularView<Eigen::StrictlyUpper>() = m.transpose();
      mirror_lower_in_place(m);
      EXPECT_EQ(m, expected) << n;
    }
  });
}

}  // namespace
}  // namespace posemix::internal
