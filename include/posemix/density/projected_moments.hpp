// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

namespace posemix {

/// log C of a projected Gaussian (MPG paper, eq. 12): C = E[(1 + u.u)^-2] for u ~ N(mean,
/// covariance). C is taken over the half sphere of quaternions; over the whole sphere it is twice
/// as large.
///
/// With (1 + x)^-2 = int_0^inf s exp(-s (1 + x)) ds the integral over u is Gaussian,
///   C = int_0^inf s exp(-s) |I + 2 s S|^-1/2 exp(-s m^T (I + 2 s S)^-1 m) ds,
/// The integral over s is by the double exponential rule, for means beyond 10 by trapezoids in ln
/// s. Relative error below 1e-12 for eigenvalues of S up to 1e4.
double projected_log_normalizer(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance);

/// Moments of u under the distribution of a projected Gaussian, whose density is proportional to
/// N(u; m, S) with respect to dm = (1 + u.u)^-2 du. Computed by the same rule as the normaliser.
struct ProjectedMoments {
  double log_normalizer;          ///< log C
  Eigen::Vector3d mean;           ///< E[u]
  Eigen::Matrix3d second_moment;  ///< E[u u^T]
  Eigen::Matrix3d rotation;       ///< E[R(u)], R(u) the rotation matrix of (1, u)
};

/// The moments of u for a Gaussian N(mean, covariance) in the tangent space.
ProjectedMoments projected_moments(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance);

/// Variances of a zero-mean projected Gaussian with diagonal covariance.
struct ProjectedVariances {
  Eigen::Vector3d variances;
  bool converged;  ///< false if a moment is not met, because of a bound or for another reason
};

/// The variances, within bounds, that are most likely for samples with the moments E[u_i^2]. If no
/// bound is active, the distribution has these moments.
/// @param lower lower bounds of the variances; zero for no bound
ProjectedVariances projected_variances_of_moments(const Eigen::Vector3d& moments,
                                                  const Eigen::Vector3d& lower,
                                                  const Eigen::Vector3d& upper);

/// Covariance of a zero-mean projected Gaussian.
struct ProjectedCovariance {
  Eigen::Matrix3d covariance;
  bool converged;  ///< false if the moment is so wide that an eigenvalue of S is at the limit
};

/// The covariance S with which the zero-mean distribution has the second moment E[u u^T]; it is the
/// maximum-likelihood covariance of samples with that moment.
/// @param limit largest eigenvalue of S
ProjectedCovariance projected_covariance_of_moment(const Eigen::Matrix3d& second_moment,
                                                   double limit = 1e4);

}  // namespace posemix
