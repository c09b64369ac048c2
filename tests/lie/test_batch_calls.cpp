// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"
#include "posemix/lie/batch.hpp"
#include "posemix/lie/batch_rows.hpp"

// What holds for every function of batches, whatever it computes.
namespace posemix {
namespace {

using internal::by_every_instruction_set;

using testing::kNan;

/// Of angles up to four radians and some beyond.
std::vector<Vector6d> tangents(std::size_t count) {
  RandomStream stream(3);
  std::vector<Vector6d> xi(count);
  for (Vector6d& one : xi) {
    for (double& x : one) x = 1.5 * stream.normal();
  }
  return xi;
}

TEST(BatchCalls, WhatIsNotANumberStaysInItsPlace) {
  by_every_instruction_set([] {
    std::vector<Vector6d> xi(9, Vector6d::Constant(0.1));
    for (int k = 0; k < 6; ++k) xi[static_cast<std::size_t>(k)][k] = kNan;
    std::vector<SE3d> x(9);
    std::vector<Vector6d> logs(9);
    std::vector<Matrix6d> jacobians(9);
    batch::exp(xi, x);
    batch::log(x, logs);
    batch::left_jacobian_inverse(xi, jacobians);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(x[i].rotation().quaternion().coeffs().hasNaN(), i < 3) << i;
      EXPECT_TRUE(x[i].translation().hasNaN()) << i;
      EXPECT_TRUE(logs[i].hasNaN()) << i;
      EXPECT_TRUE(jacobians[i].hasNaN()) << i;
    }
    for (std::size_t i = 6; i < 9; ++i) {
      EXPECT_LT((logs[i] - xi[i]).norm(), 1e-15) << i;
      EXPECT_FALSE(jacobians[i].hasNaN()) << i;
    }
  });
}

/// Numbers that end where no memory is.
class LastNumbers {
 public:
  explicit LastNumbers(std::size_t count) {
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    used_ = (count * sizeof(double) + page - 1) / page * page;
    size_ = used_ + page;
    memory_ = static_cast<char*>(
        ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    EXPECT_EQ(::mprotect(memory_ + used_, page, PROT_NONE), 0);
    first_ = reinterpret_cast<double*>(memory_ + used_) - count;
  }
  LastNumbers(const LastNumbers&) = delete;
  LastNumbers& operator=(const LastNumbers&) = delete;
  ~LastNumbers() { ::munmap(memory_, size_); }

  double* data() const { return first_; }

 private:
  std::size_t used_ = 0;
  std::size_t size_ = 0;
  char* memory_ = nullptr;
  double* first_ = nullptr;
};

TEST(BatchCalls, NothingIsTouchedBehindAResult) {
  by_every_instruction_set([] {
    for (const std::size_t count : {1u, 2u, 3u, 7u, 8u, 9u, 16u, 64u}) {
      const std::vector<Vector6d> xi = tangents(count);
      const internal::ConstRows in{xi.front().data(), 6};
      // Poses in rows of seven numbers, as arrays of Python have them; their rotations and vectors.
      const LastNumbers poses(7 * count);
      internal::exp_of(in, {poses.data() + 3, poses.data(), 7}, count);
      const LastNumbers rotations(4 * count);
      internal::so3_exp_of(in, {rotations.data(), 4}, count);
      const LastNumbers vectors(3 * count);
      internal::so3_log_of({rotations.data(), 4}, {vectors.data(), 3}, count);
      const SE3d last = SE3d::exp(xi.back());
      EXPECT_NEAR(poses.data()[7 * count - 7], last.translation()[0], 1e-13);
      EXPECT_NEAR(vectors.data()[3 * count - 1], last.rotation().log()[2], 1e-12);
    }
  });
}

TEST(BatchCalls, OfNothingIsNothing) {
  batch::exp(std::span<const Vector6d>(), std::span<SE3d>());
  batch::log(std::span<const SO3d>(), std::span<Eigen::Vector3d>());
  batch::left_jacobian(std::span<const Vector6d>(), std::span<TwistMatrix<double>>());
  batch::compose(batch::UncertainPoses{}, batch::UncertainPoses{}, batch::UncertainPosesResult{});
}

TEST(BatchCalls, TheBitsAreTheSameForAnyNumberOfThreads) {
  const std::vector<Vector6d> xi = tangents(50001);
  std::vector<SE3d> one(xi.size());
  std::vector<Matrix6d> one_jacobians(xi.size());
  std::vector<Vector6d> one_logs(xi.size());
  std::vector<SE3d> one_means(xi.size());
  std::vector<Matrix6d> one_covariances(xi.size());
  batch::exp(xi, one);
  batch::log(one, one_logs);
  batch::left_jacobian_inverse(xi, one_jacobians);
  const Matrix6d own = Vector6d::LinSpaced(6, 1.0, 6.0).asDiagonal();
  const std::vector<Matrix6d> p(xi.size(), own);
  batch::compose({one, p}, {one, p}, {one_means, one_covariances});
  for (const std::size_t threads : {0u, 2u, 3u, 7u}) {
    std::vector<SE3d> several(xi.size());
    std::vector<Matrix6d> jacobians(xi.size());
    batch::exp(xi, several, threads);
    batch::left_jacobian_inverse(xi, jacobians, threads);
    std::vector<Vector6d> logs(xi.size());
    batch::log(one, logs, threads);
    std::vector<SE3d> means(xi.size());
    std::vector<Matrix6d> covariances(xi.size());
    batch::compose({one, p}, {one, p}, {means, covariances}, threads);
    for (std::size_t i = 0; i < xi.size(); ++i) {
      ASSERT_EQ(logs[i], one_logs[i]) << threads << " threads, item " << i;
      ASSERT_EQ(means[i].matrix(), one_means[i].matrix()) << threads << " threads, item " << i;
      ASSERT_EQ(covariances[i], one_covariances[i]) << threads << " threads, item " << i;
      ASSERT_EQ(several[i].matrix(), one[i].matrix()) << threads << " threads, item " << i;
      ASSERT_EQ(jacobians[i], one_jacobians[i]) << threads << " threads, item " << i;
    }
  }
}

TEST(BatchCalls, AResultDoesNotDependOnItsNeighbours) {
  by_every_instruction_set([] {
    const std::vector<Vector6d> xi = tangents(57);
    std::vector<SE3d> all(xi.size());
    std::vector<Vector6d> logs(xi.size());
    batch::exp(xi, all);
    batch::log(all, logs);
    for (std::size_t i = 0; i < xi.size(); ++i) {
      SE3d one;
      Vector6d log;
      batch::exp({&xi[i], 1}, {&one, 1});
      batch::log({&one, 1}, {&log, 1});
      EXPECT_EQ(one.matrix(), all[i].matrix()) << i;
      EXPECT_EQ(log, logs[i]) << i;
    }
  });
}

TEST(BatchCalls, AResultMayBeAnArgument) {
  by_every_instruction_set([] {
    std::vector<SE3d> x;
    for (const Vector6d& xi : tangents(57)) x.push_back(SE3d::exp(xi));
    const std::vector<SE3d> y(x.rbegin(), x.rend());
    std::vector<SE3d> expected(x.size());
    batch::compose(x, y, expected);
    std::vector<SE3d> found = x;
    batch::compose(found, y, found);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(found[i].matrix(), expected[i].matrix());
  });
}

TEST(BatchCalls, NoItemsAreNoWork) {
  std::vector<SE3d> none;
  EXPECT_NO_THROW(batch::exp(std::vector<Vector6d>(), none, 4));
}

TEST(BatchCalls, NumbersOfItemsThatDifferAreRefused) {
  const std::vector<Eigen::Vector3d> phi(2);
  const std::vector<Vector6d> xi(2);
  std::vector<SO3d> r(3);
  std::vector<SE3d> x(3);
  std::vector<Eigen::Vector3d> phi_out(4);
  std::vector<Vector6d> xi_out(4);
  std::vector<Eigen::Matrix3d> small(3);
  std::vector<Matrix6d> p(3);
  std::vector<TwistMatrix<double>> blocks(3);
  EXPECT_THROW(batch::exp(phi, r), InvalidInput);
  EXPECT_THROW(batch::exp(xi, x), InvalidInput);
  EXPECT_THROW(batch::log(r, phi_out), InvalidInput);
  EXPECT_THROW(batch::log(x, xi_out), InvalidInput);
  EXPECT_THROW(batch::left_jacobian(phi, small), InvalidInput);
  EXPECT_THROW(batch::left_jacobian(xi, p), InvalidInput);
  EXPECT_THROW(batch::left_jacobian(xi, blocks), InvalidInput);
  EXPECT_THROW(batch::left_jacobian_inverse(phi, small), InvalidInput);
  EXPECT_THROW(batch::left_jacobian_inverse(xi, p), InvalidInput);
  EXPECT_THROW(batch::left_jacobian_inverse(xi, blocks), InvalidInput);
  std::vector<SO3d> r_out(4);
  std::vector<SE3d> x_out(4);
  EXPECT_THROW(batch::compose(r, r, r_out), InvalidInput);
  EXPECT_THROW(batch::compose(x, x, x_out), InvalidInput);
  EXPECT_THROW(batch::compose(r, r_out, r), InvalidInput);
  EXPECT_THROW(batch::compose(x, x_out, x), InvalidInput);
  EXPECT_THROW(batch::inverse(r, r_out), InvalidInput);
  EXPECT_THROW(batch::inverse(x, x_out), InvalidInput);
  std::vector<Matrix6d> p_out(4);
  EXPECT_THROW(batch::adjoint_congruence(x, p, p_out), InvalidInput);
  EXPECT_THROW(batch::adjoint_congruence(x_out, p, p), InvalidInput);
  EXPECT_THROW(batch::compose({x, p}, {x, p_out}, {x, p}), InvalidInput);
  EXPECT_THROW(batch::between({x, p}, {x, p}, {x, p_out}), InvalidInput);
  EXPECT_THROW(batch::inverse({x, p_out}, {x, p}), InvalidInput);
}

}  // namespace
}  // namespace posemix
