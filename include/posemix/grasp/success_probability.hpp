// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/projected_gaussian.hpp"
#include "posemix/mixture/mixture.hpp"

/// The grasp criterion (MPG paper, section V): how likely a pose lies in the box of poses that a
/// grasp tolerates, and where the box should be.
namespace posemix {

/// The box B of poses X in the frame of the grasp, X = (R, t): |u_i| <= tan(rotation_i / 2) for R =
/// R(u) in the gnomonic chart at the identity, |t_i| <= translation_i. With a rotation of pi any
/// turn about that axis is tolerated; after a turn by theta, tilts about the two others are
/// tolerated up to about cos(theta / 2) of what is tolerated without.
struct ToleranceBox {
  Eigen::Vector3d rotation;     ///< largest rotation about each axis, at most pi [rad]
  Eigen::Vector3d translation;  ///< largest translation along each axis [m]
};

/// Settings of `success_probability`.
struct SuccessSettings {
  std::size_t points = 1 << 9;  ///< for every component in every replicate
  std::size_t replicates = 8;   ///< independent randomisations, at least 2
};

/// A probability by randomised quasi-Monte Carlo.
struct SuccessEstimate {
  double probability;  ///< in [0, 1]
  /// One standard error, from the replicates; for components that were drawn from, also for the
  /// probability of one draw.
  double error;
  std::size_t evaluations;
};

/// The probability that a pose lies in `m(B) = {m X : X in B}`.
///
/// Every component becomes a Gaussian in the coordinates of the box; Genz's separation of
/// variables \cite genz1992 draws points from that Gaussian within the box, and each counts with
/// the exact ratio of the density to the Gaussian, so the estimate is unbiased.
///
/// Where box and component meet beyond an angle of 90 degrees from the centre of the box, the
/// coordinates are those about the half turn from there that is nearest to the component. A
/// component that is too wide for these too (four standard deviations beyond 90 degrees) has half
/// of its points drawn from itself, wherever they lie and also where they wrap around at pi; all
/// count with the ratio of the density to that of both kinds of points, and the known integral of
/// the one is the control variate \cite owen2000safe.
/// @param m frame of the grasp in the reference frame of the mixture
/// @throws InvalidInput for a box with a side that is not positive or a rotation of more than pi,
/// for fewer than 2 replicates or no points, and for a frame that is not finite or beyond 1e8 m
template <class D>
SuccessEstimate success_probability(const Mixture<D>& mixture, const ToleranceBox& box,
                                    const SE3d& m, RandomStream& stream,
                                    const SuccessSettings& settings = {});

/// Settings of `best_grasp`.
struct BestGraspSettings {
  std::size_t starts = 5;    ///< the modes of so many of the heaviest components
  std::size_t points = 64;   ///< per component while searching, the same for every m
  int max_evaluations = 60;  ///< of the gradient, for every start
  double tolerance = 1e-5;   ///< stop when an iteration gains less, relative
  SuccessSettings final{};   ///< for the probabilities reported
};

/// Where one start ended.
struct GraspCandidate {
  SE3d start;
  SE3d pose;
  SuccessEstimate success;
};

/// The pose that maximises the probability, and what every start found, best first.
struct BestGrasp {
  SE3d pose;
  SuccessEstimate success;
  std::vector<GraspCandidate> candidates;
  int evaluations;  ///< of the probability while searching
};

/// arg max over m of the probability that a pose lies in m(B), by L-BFGS (NLopt) with numerical
/// gradients from the modes of the heaviest components.
/// @throws InvalidInput as success_probability, and for no starts
template <class D>
BestGrasp best_grasp(const Mixture<D>& mixture, const ToleranceBox& box, RandomStream& stream,
                     const BestGraspSettings& settings = {});

extern template SuccessEstimate success_probability(const Mixture<ConcentratedGaussian<SE3d>>&,
                                                    const ToleranceBox&, const SE3d&, RandomStream&,
                                                    const SuccessSettings&);
extern template SuccessEstimate success_probability(const Mixture<ProjectedGaussian<SE3d>>&,
                                                    const ToleranceBox&, const SE3d&, RandomStream&,
                                                    const SuccessSettings&);
extern template BestGrasp best_grasp(const Mixture<ConcentratedGaussian<SE3d>>&,
                                     const ToleranceBox&, RandomStream&, const BestGraspSettings&);
extern template BestGrasp best_grasp(const Mixture<ProjectedGaussian<SE3d>>&, const ToleranceBox&,
                                     RandomStream&, const BestGraspSettings&);

}  // namespace posemix
