// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/base/random.hpp"
#include "posemix/lie/lie.hpp"

/// The errors of a pose estimate that a grasp forgives (MPG paper, section V: there a box about
/// zero).
namespace posemix {

/// Errors within which a grasp succeeds: a box with soft walls.
///
/// The error of an estimate is E = T_truth^-1 T_estimate. With its rotation vector phi and its
/// translation t, both in the true object's axes, the box is one in
///   x = (phi, t + phi x p),
/// that is, in the displacement of the object's point p (`lever`) where the fingers meet it, and
///   P(success) = c0 + (c1 - c0) prod_k s((x_k - c_k + w_k) / (kappa w_k)) s((c_k + w_k - x_k) /
///   (kappa w_k)),
/// where s is the logistic function. kappa = 0 is the paper's box with hard walls.
struct ToleranceRegion {
  Vector6d centre = Vector6d::Zero();  ///< c [rad, m]
  /// w [rad, m], positive; infinite where the grasp forgives everything.
  Vector6d half_width = Vector6d::Constant(std::numeric_limits<double>::infinity());
  double softness = 0.0;                            ///< kappa, not negative
  Eigen::Vector3d lever = Eigen::Vector3d::Zero();  ///< p [m], true object frame
  double success_inside = 1.0;                      ///< c1
  double success_outside = 0.0;                     ///< c0

  /// Probability that a grasp with this error succeeds.
  double success_probability(const SE3d& error) const {
    return success_probability(error.rotation().log(), error.translation());
  }
  /// The same by the error's rotation vector [rad] and translation [m].
  double success_probability(const Eigen::Vector3d& rotation,
                             const Eigen::Vector3d& translation) const;
};

/// @throws InvalidInput when a width is not positive, the softness negative, or c0, c1 are not
/// probabilities with c0 <= c1
void validate(const ToleranceRegion& region);

/// A grasp that was tried: the error of the estimate it was planned with, and what became of it.
struct ErrorOutcome {
  SE3d error;  ///< T_truth^-1 T_estimate
  bool success;
};

/// Priors of fit_tolerance_region; independent normal distributions, with mean and standard
/// deviation. The centre's and the lever's means are zero.
struct RegionPriors {
  double centre_rotation_sd_deg = 3.0;
  double centre_translation_sd_m = 5e-3;
  double half_width_deg = 12.0;    ///< median
  double half_width_m = 12e-3;     ///< median
  double log_half_width_sd = 0.7;  ///< of ln w
  double softness = 0.2;           ///< median
  double log_softness_sd = 0.7;
  double logit_inside = 3.0;  ///< of c1
  double logit_inside_sd = 1.5;
  double logit_outside_ratio = -4.0;  ///< of c0 / c1
  double logit_outside_ratio_sd = 1.5;
  double lever_sd_m = 0.04;
};

/// Settings of fit_tolerance_region.
struct RegionFitSettings {
  RegionPriors priors = {};
  int starts = 4;  ///< the first at the prior's modes, the second at the successes' median
  int max_evaluations = 400;
  double tolerance = 1e-7;  ///< relative, of the log posterior
};

/// A fitted region.
struct RegionFit {
  ToleranceRegion region;
  double log_posterior;  ///< up to a constant that depends on the settings only [nats]
  bool converged;        ///< of the start that was kept
  std::size_t successes;
  std::size_t failures;
  /// The outcomes say more about the width than the prior does (Fisher information). Where they do
  /// not, the width is about the prior's.
  std::array<bool, 6> identified;
};

/// Number of parameters of a region: c, ln w, ln kappa, logit c1, logit(c0 / c1), p.
inline constexpr int kRegionParameters = 18;
using RegionParameters = Eigen::Matrix<double, kRegionParameters, 1>;

/// Parameters in the order above; rotations in degrees, translations in millimetres.
/// @throws InvalidInput for a region with hard walls, infinite widths, or c0, c1 of 0 or 1, which
/// have none
RegionParameters parameters_of(const ToleranceRegion& region);
ToleranceRegion region_of(const RegionParameters& parameters);

/// Log posterior of parameters given outcomes, and its gradient where one is asked for.
double region_log_posterior(const RegionParameters& parameters,
                            std::span<const ErrorOutcome> outcomes, const RegionPriors& priors,
                            RegionParameters* gradient = nullptr);

/// Most probable region given outcomes: the best of several starts, each by L-BFGS (NLopt).
/// Without outcomes, that of the prior.
/// @throws InvalidInput when there is no start
RegionFit fit_tolerance_region(std::span<const ErrorOutcome> outcomes,
                               const RegionFitSettings& settings, RandomStream& stream);

/// Regions fitted to `count` bootstrap samples of the outcomes, drawn by whole groups (outcomes of
/// one image are alike). Outcomes of few scenes leave some walls open; the regions' mean is unsure
/// there, where the most probable region alone is not.
/// @throws InvalidInput when `groups` does not hold one group per outcome
std::vector<ToleranceRegion> bootstrap_regions(std::span<const ErrorOutcome> outcomes,
                                               std::span<const std::size_t> groups,
                                               std::size_t count, const RegionFitSettings& settings,
                                               RandomStream& stream);

}  // namespace posemix
