// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "posemix/base/error.hpp"

/// Expectations for the tests of several rooms.
namespace posemix::testing {

/// The message of the InvalidInput that `action` throws; empty if it throws none.
template <class Action>
std::string thrown_message(Action&& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

/// Largest absolute difference of two matrices of the same size, relative to the largest entry of
/// `expected`; infinite if an entry is not finite or the sizes differ.
template <class A, class B>
double relative_difference(const Eigen::MatrixBase<A>& actual,
                           const Eigen::MatrixBase<B>& expected) {
  const bool comparable =
      actual.rows() == expected.rows() && actual.cols() == expected.cols() && actual.allFinite();
  if (!comparable) return std::numeric_limits<double>::infinity();
  const double difference = (actual - expected).cwiseAbs().maxCoeff();
  return difference == 0.0 ? 0.0 : difference / expected.cwiseAbs().maxCoeff();
}

/// Succeeds if no entry of two matrices differs by more than `tolerance`.
template <class A, class B>
::testing::AssertionResult matrices_near(const Eigen::MatrixBase<A>& actual,
                                         const Eigen::MatrixBase<B>& expected, double tolerance) {
  const bool same_size = actual.rows() == expected.rows() && actual.cols() == expected.cols();
  if (same_size && (actual - expected).cwiseAbs().maxCoeff() <= tolerance) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "tolerance " << tolerance << ", actual\n"
                                       << actual << "\nexpected\n"
                                       << expected;
}

}  // namespace posemix::testing
