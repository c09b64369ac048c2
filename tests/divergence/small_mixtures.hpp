// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/base/random.hpp"
#include "posemix/mixture/mixture.hpp"

namespace posemix::testing {

/// A correlated covariance; `deviation` is its root mean square standard deviation, roughly.
inline Eigen::MatrixXd correlated(RandomStream& stream, Eigen::Index n, double deviation) {
  Eigen::VectorXd entries(n * n);
  stream.fill_normal(entries);
  const Eigen::MatrixXd root = entries.reshaped(n, n);
  Eigen::MatrixXd covariance =
      deviation * deviation *
      (root * root.transpose() / static_cast<double>(n) + 0.3 * Eigen::MatrixXd::Identity(n, n));
  symmetrize(covariance);
  return covariance;
}

/// A mixture of one component.
template <class D>
Mixture<D> single(const D& density) {
  return Mixture<D>({{0.0, density}});
}

}  // namespace posemix::testing
