// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

namespace posemix {

/// log C of a projected Gaussian (MPG paper, eq. 12, over the half sphere of quaternions: on the
/// whole sphere it is twice that): C = E[(1 + u.u)^-2] for u ~ N(mean, covariance).
///
/// With (1 + x)^-2 = int_0^inf s exp(-s (1 + x)) ds the integral over u is Gaussian,
///   C = int_0^inf s exp(-s) |I + 2 s S|^-1/2 exp(-s m^T (I + 2 s S)^-1 m) ds,
/// and what is left is done by the double exponential rule. Relative error below 1e-12 for
/// eigenvalues of S up to 1e4.
double projected_log_normalizer(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance);

/// Moments of u under the distribution of a projected Gaussian, density proportional to N(u; m, S)
/// with respect to dm = (1 + u.u)^-2 du. By the same rule.
struct ProjectedMoments {
  double log_normalizer;          ///< log C
  Eigen::Vector3d mean;           ///< E[u]
  Eigen::Matrix3d second_moment;  ///< E[u u^T]
  Eigen::Matrix3d rotation;       ///< E[R(u)], R(u) the rotation matrix of (1, u)
};

ProjectedMoments projected_moments(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance);

/// The variances l, within bounds, of the zero-mean projected Gaussian with diagonal covariance
/// that are most likely for samples with the moments E[u_i^2]: where no bound is met, those that
/// have them.
struct ProjectedVariances {
  Eigen::Vector3d variances;
  bool converged;  ///< false where a moment is not met, for a bound or otherwise
};

/// @param lower bounds; zero where there is none
ProjectedVariances projected_variances_of_moments(const Eigen::Vector3d& moments,
                                                  const Eigen::Vector3d& lower,
                                                  const Eigen::Vector3d& upper);

/// The covariance S of the zero-mean projected Gaussian whose second moment E[u u^T] is the given
/// one: the maximum-likelihood covariance of samples with that moment.
struct ProjectedCovariance {
  Eigen::Matrix3d covariance;
  bool converged;  ///< false where the moment is so wide that an eigenvalue of S met the limit
};

/// @param limit largest eigenvalue of S
ProjectedCovariance projected_covariance_of_moment(const Eigen::Matrix3d& second_moment,
                                                   double limit = 1e4);

}  // namespace posemix
