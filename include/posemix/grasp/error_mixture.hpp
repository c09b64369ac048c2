// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/base/random.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/mixture/mixture.hpp"

/// How a pose estimator errs: a mixture fitted to its errors, with a component for outliers.
namespace posemix {

/// Error of an estimate T_camera_object in the frame of its line of sight, [rotation vector;
/// displacement] in rad and m: the rotation vector of R_estimate R_truth^-1 and the displacement
/// t_estimate - t_truth, both in axes that are the camera's turned, by the least angle, so that z
/// points to the estimate. Depth is then the last entry.
Vector6d sight_error(const SE3d& estimate, const SE3d& truth);

/// The truth of which `estimate` has this error. Inverse of sight_error for rotations below pi.
SE3d truth_with_error(const SE3d& estimate, const Vector6d& error);

/// A mixture of Gaussians over errors as sight_error gives them.
class ErrorMixture {
 public:
  using Gaussian = ConcentratedGaussian<Rnd<6>>;

  explicit ErrorMixture(Mixture<Gaussian> mixture);

  const Mixture<Gaussian>& mixture() const { return mixture_; }

  /// Log of the density of an error in its six coordinates [nats].
  double log_density(const Vector6d& error) const;

  /// Log of the density of the truth with that error, with respect to the Haar measure [rad^3 m^3]:
  /// the same less log |det J_l| of the rotation vector.
  double log_pose_density(const Vector6d& error) const;

  Vector6d sample(RandomStream& stream) const;

 private:
  struct Part {
    Vector6d mean;
    Matrix6d whitening;  ///< inverse of the lower Cholesky factor
    double log_factor;   ///< log weight + log normaliser
  };

  Mixture<Gaussian> mixture_;
  std::vector<Part> parts_;
};

/// Settings of fit_error_mixture.
struct ErrorMixtureSettings {
  std::size_t max_components = 7;  ///< full ones, besides that of the outliers
  double prior_count = 7.0;        ///< samples that the prior of a covariance counts as
  double prior_scale = 0.5;        ///< its value, in diagonal covariances of the trimmed errors
  double outlier_rotation_sd_deg = 60.0;   ///< fixed; about every axis
  double outlier_translation_sd_m = 0.15;  ///< fixed; along every axis
  double trim = 5.0;  ///< robust standard deviations beyond which an error is an outlier
  int restarts = 2;   ///< starts at every number of components
  int max_iterations = 300;
  double tolerance = 1e-5;  ///< gain per error and iteration that ends an EM run [nats]
};

/// A fitted mixture.
struct ErrorMixtureFit {
  ErrorMixture errors;     ///< the outliers' component is the last
  std::size_t components;  ///< full ones
  double log_likelihood;
  double bic;  ///< smallest among the numbers of components that were tried
  /// Log posterior after every iteration of the run that was kept: never decreases.
  std::vector<double> history;
};

/// Fits mixtures of 1, 2, ... full components and a fixed wide one with a free weight, by maximum
/// a posteriori expectation maximisation, and keeps that with the smallest BIC. A component's
/// covariance has the prior (|P|^-1/2 exp(-tr(P^-1 P0) / 2))^prior_count, so that it is never
/// singular. A number of components that does not lower the BIC twice in a row ends the search.
/// @throws InvalidInput when there are fewer than 8 errors
ErrorMixtureFit fit_error_mixture(std::span<const Vector6d> errors,
                                  const ErrorMixtureSettings& settings, RandomStream& stream);

/// The errors within `trim` robust standard deviations (1.4826 times the median distance from the
/// median) on every axis; all where fewer than 8 are.
std::vector<Vector6d> trimmed_errors(std::span<const Vector6d> errors, double trim);

/// One Gaussian with the mean and the covariance of the errors (1e-12 rad^2, m^2 added to the
/// diagonal). @throws InvalidInput when there are fewer than 8 errors
ErrorMixture fit_error_gaussian(std::span<const Vector6d> errors);

}  // namespace posemix
