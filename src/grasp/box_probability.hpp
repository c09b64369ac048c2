// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>

#include "posemix/base/linear.hpp"

namespace posemix::internal {

/// N(mean, covariance) in six dimensions, its points within |y_i| <= limit_i drawn by separation of
/// variables: coordinate after coordinate from the Gaussian conditional on those before, cut at the
/// limits \cite genz1992.
class BoxedGaussian {
 public:
  BoxedGaussian(const Vector6d& mean, const Matrix6d& covariance, const Vector6d& limit);

  /// A point within the box and the log of its weight: the mean of the weights over uniform points
  /// of the unit cube is the probability of the box. Divided by the Gaussian's density the weight
  /// is that of a point of the box itself.
  struct Point {
    Vector6d y;
    double log_weight;
    double log_density;
  };
  Point at(const Vector6d& uniform) const;

 private:
  std::array<Eigen::Index, 6> order_;  ///< the tightest limit first
  Vector6d mean_;                      ///< in that order
  Vector6d limit_;
  Matrix6d factor_;
  double log_constant_;
};

}  // namespace posemix::internal
