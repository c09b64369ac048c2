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

/// The density of the true pose given an estimate, for the fusion of several estimators: a mixture
/// fitted to their errors, with a component for outliers. A DetectorNoise states the opposite, the
/// density of a detection given the truth, as a filter needs it; so its axes are those of the
/// viewing ray of the truth, its components have no mean along that ray, and lengths are by the
/// range.
namespace posemix {

/// Error of an estimate T_camera_object along the axes of its viewing ray (viewing_ray), [rotation
/// vector; displacement] in rad and m: the rotation vector of R_estimate R_truth^-1 and the
/// displacement t_estimate - t_truth. Depth is the last entry.
Vector6d sight_error(const SE3d& estimate, const SE3d& truth);

/// The truth whose estimate has this error: the inverse of sight_error for rotations below pi.
SE3d truth_with_error(const SE3d& estimate, const Vector6d& error);

/// A mixture of Gaussians over errors in the coordinates of sight_error.
class ErrorMixture {
 public:
  using Gaussian = ConcentratedGaussian<Rnd<6>>;

  explicit ErrorMixture(Mixture<Gaussian> mixture);

  const Mixture<Gaussian>& mixture() const { return mixture_; }

  /// Log of the density of an error in its six coordinates [nats].
  double log_density(const Vector6d& error) const;

  /// Log of the density of the truth with that error, with respect to the Haar measure [per rad^3
  /// m^3]: log_density less log |det J_l| of the rotation vector.
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
  std::size_t max_components = 7;  ///< besides the component of the outliers
  double prior_count = 7.0;        ///< samples that the prior of a covariance counts as
  /// Value of the prior covariance, in units of the diagonal covariance of the trimmed errors.
  double prior_scale = 0.5;
  double outlier_rotation_sd_deg = 60.0;   ///< of the outliers' component, about every axis; fixed
  double outlier_translation_sd_m = 0.15;  ///< the same along every axis
  double trim = 5.0;  ///< robust standard deviations beyond which an error is an outlier
  int restarts = 2;   ///< starts for every number of components
  int max_iterations = 300;
  double tolerance = 1e-5;  ///< gain per error and iteration that ends an EM run [nats]
};

/// A fitted mixture.
struct ErrorMixtureFit {
  ErrorMixture errors;     ///< the outliers' component is the last
  std::size_t components;  ///< besides the component of the outliers
  double log_likelihood;
  double bic;  ///< the least among the numbers of components that were tried
  /// Log posterior after every iteration of the run that was kept: never decreases.
  std::vector<double> history;
};

/// Fits mixtures of 1, 2, ... full components and a fixed wide one with a free weight, by maximum
/// a posteriori expectation maximisation, and keeps the mixture with the least BIC. A component's
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
