// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/detector/error_mixture.hpp"
#include "posemix/detector/symmetry.hpp"
#include "posemix/grasp/tolerance_region.hpp"

/// Several estimates of one pose fused, and the probability of success of a grasp that follows.
namespace posemix {

/// An estimate and the errors of its estimator.
struct ConsensusMember {
  SE3d estimate;               ///< T_camera_object
  const ErrorMixture* errors;  ///< not null
};

/// Settings of fuse_estimates.
struct ConsensusSettings {
  std::size_t draws_per_member = 320;
  /// Correlation of the members' errors. Densities are multiplied to the power of
  /// 1 / (1 + (n - 1) correlation) for n members: the information that the mean of n equally
  /// correlated errors has, in members.
  double correlation = 0.5;
};

/// Weighted draws of the true pose.
struct PoseConsensus {
  std::vector<SE3d> truths;
  Eigen::VectorXd weights;  ///< sum one

  /// 1 / sum of the squared weights.
  double effective_draws() const { return 1.0 / weights.squaredNorm(); }

  /// `count` draws of equal weight (systematic resampling: equal steps of the summed weights).
  PoseConsensus resampled(std::size_t count) const;
};

/// The product of the members' densities of the truth (to the power above) by importance sampling
/// from their mean, with respect to the Haar measure.
/// @throws InvalidInput without members or draws, for a member without errors, or when the
/// correlation is not within [0, 1]
PoseConsensus fuse_estimates(std::span<const ConsensusMember> members,
                             const ConsensusSettings& settings, RandomStream& stream);

/// Probability that a grasp planned with `estimate` succeeds: the mean over the draws of the truth
/// and over the regions (MPG paper, section V, there with one box). Errors are reduced by the
/// symmetries of the object.
/// @throws InvalidInput without a region, and unless there is one weight for each draw
double success_probability(const PoseConsensus& consensus, const SE3d& estimate,
                           std::span<const ToleranceRegion> regions,
                           const SymmetryGroup& symmetries = {});

}  // namespace posemix
