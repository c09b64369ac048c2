// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cstddef>

#include <gtest/gtest.h>

#include "posemix/base/linear.hpp"

namespace posemix {
namespace {

Eigen::MatrixXd long_product() {
  Eigen::MatrixXd a(64, 3000);
  for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = 1.0 / (3.0 + static_cast<double>(i));
  return a * a.transpose();
}

/// The caches of the machine, by which Eigen sums, would be others on each.
TEST(EigenBlocking, DoesNotDependOnTheMachine) {
  const Eigen::MatrixXd product = long_product();
  EXPECT_EQ(checked_covariance(Eigen::MatrixXd(product + Eigen::MatrixXd::Identity(64, 64)), 64, "")
                .rows(),
            64);
  std::ptrdiff_t l1 = 0, l2 = 0, l3 = 0;
  Eigen::internal::manage_caching_sizes(Eigen::GetAction, &l1, &l2, &l3);
  EXPECT_EQ(l1, 32 << 10);
  EXPECT_EQ(l2, 512 << 10);
  EXPECT_EQ(l3, 4 << 20);
  Eigen::setCpuCacheSizes(48 << 10, 2 << 20, 32 << 20);
  const Eigen::MatrixXd of_others = long_product();
  Eigen::setCpuCacheSizes(l1, l2, l3);
  EXPECT_NE(of_others, product) << "where the sizes do not matter this test tells nothing";
  EXPECT_EQ(long_product(), product);
}

}  // namespace
}  // namespace posemix
