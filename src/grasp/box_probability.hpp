// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <optional>

#include "posemix/base/linear.hpp"

namespace posemix::internal {

/// The point with probability p below it under a standard normal, 0 < p < 1.
double normal_quantile(double p);

/// The region of a BoxedGaussian in the coordinates [u; t] of a gnomonic chart. In the chart at the
/// centre of a tolerance box it is |y_i| <= limit_i. In the chart that is turned from the centre by
/// pi about axis k, where u_k = w / q_k for a rotation with quaternion (q, w) in the frame of the
/// box, it is |u_k| >= 1 / limit_k and |u_i| <= limit_j |u_k| for the two other axes i and j.
struct BoxRegion {
  /// The box with the limits [tan(rotation / 2); translation] in its own chart.
  explicit BoxRegion(const Vector6d& limits) : limit(limits) {}
  /// The same box in the chart that is turned by pi about an axis.
  BoxRegion(const Vector6d& limits, Eigen::Index axis);

  Vector6d limit;
  std::optional<Eigen::Index> turned;  ///< the axis k
  double least = 0.0;                  ///< of |u_k|
};

/// N(mean, covariance) in six dimensions, its points within a region drawn by separation of
/// variables: coordinate after coordinate from the Gaussian conditional on those before, cut at the
/// limits, which may depend on those before \cite genz1992.
class BoxedGaussian {
 public:
  BoxedGaussian(const Vector6d& mean, const Matrix6d& covariance, const BoxRegion& region);

  /// A point within the region and the log of its weight: the mean of the weights over uniform
  /// points of the unit cube is the probability of the region. Divided by the Gaussian's density
  /// the weight is that of a point of the region itself.
  struct Point {
    Vector6d y;
    double log_weight;
    double log_density;
  };
  Point at(const Vector6d& uniform) const;

  /// Log of the density of the points that `at` draws, at a point of the region; -inf where the
  /// Gaussian has no mass within the limits.
  double log_density_of_points(const Vector6d& y) const;

 private:
  /// The bounds of coordinate i in order, given those before.
  double limit(Eigen::Index i, double turned) const;

  std::array<Eigen::Index, 6> order_;  ///< the axis k first, then the tightest limit
  Vector6d mean_;                      ///< in that order
  Vector6d limit_;
  bool turned_;
  double least_;
  Matrix6d factor_;
  double log_constant_;
};

}  // namespace posemix::internal
