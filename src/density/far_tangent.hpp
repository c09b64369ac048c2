// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include <Eigen/Core>

#include "posemix/base/random.hpp"
#include "posemix/density/projected_moments.hpp"

namespace posemix::internal {

/// The integral of projected_log_normalizer over s where the mean m of u is far from the tangent
/// point: trapezoids in x = ln s, from the s at which (1 + u.u)^-2 decides, about 1 / m.m, to
/// infinity. The double exponential rule has no nodes at so small s.
///
/// Its integrand is exp(f(x)), f(x) = 2 x - g(s), g = s + sum_i (ln(1 + 2 s l_i) / 2 +
/// s m_i^2 / (1 + 2 s l_i)) along the axes of S, and g rises with s. Given s, u is Gaussian.
class FarTangent {
 public:
  FarTangent(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance);

  double log_normalizer() const;
  ProjectedMoments moments() const;
  /// One draw of u: s by rejection from steps above exp(f), then u.
  Eigen::Vector3d sample(RandomStream& stream) const;

 private:
  double g(double s) const;
  /// E[u | s] and the variances of u given s, along the axes.
  Eigen::Array3d mean_at(double s) const;
  Eigen::Array3d variance_at(double s) const;

  Eigen::Matrix3d axes_;
  Eigen::Array3d mean_;       ///< m along the axes
  Eigen::Array3d variances_;  ///< l
  std::vector<double> x_;
  std::vector<double> g_;
};

}  // namespace posemix::internal
