// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include "posemix/base/words.hpp"
#include "posemix/mixture/moments.hpp"
#include "posemix/mixture/projected_mixture.hpp"

namespace posemix {

/// The rule by which several components become one.
enum class MergeRule {
  /// Every component is moved to the tangent space at the midway point, the weighted mean of the
  /// means, where the merged mean is zero; moments are matched there (midway-merge paper, eq.
  /// 12-19).
  midway,
  /// Every component is moved to the tangent space of the component with the largest weight (the
  /// first of equals); moments are matched there, and the result is back-projected with J_l (Cesic
  /// et al. 2017).
  tangent_of_larger,
  /// Mean and covariance of the weighted sum as a random element of the group: the mean by
  /// iteration, then second moments, both by cubature (`moments`).
  moment_matched
};

/// The words of MergeRule in files and options.
template <>
inline constexpr WordTable<MergeRule, 3> words<MergeRule>{{
    {"midway", MergeRule::midway},
    {"tangent_of_larger", MergeRule::tangent_of_larger},
    {"moment_matched", MergeRule::moment_matched},
}};

/// Settings of `merge`.
struct MergeSettings {
  MergeRule rule = MergeRule::midway;
  TransportJacobian jacobian = TransportJacobian::exact;  ///< for midway and tangent_of_larger
  int max_iterations = 100;  ///< for the mean of three or more components, and for moment_matched
  double tolerance = 1e-12;  ///< norm of the last step of the mean [rad, m]
};

/// Result of `merge`: the component with the summed weight, and whether its mean converged.
template <class D>
struct MergeResult {
  Component<D> component;
  bool converged;
};

/// The midway point of the components: for two by eq. 12, for more the element M at which the
/// merged mean is zero, sum_i w_i Log(X_i M^-1) = 0 (eq. 15 and 17), by iteration. Components of
/// weight zero are treated as in `merge`.
/// @throws InvalidInput as `merge`
template <LieGroup G>
MeanResult<G> midway_point(std::span<const Component<ConcentratedGaussian<G>>> components,
                           const MergeSettings& settings = {});

/// Merges several components into one. Weights add up (eq. 19); components of weight zero are
/// ignored (if all are zero, they count equally). If the iteration does not converge, `converged`
/// is false; nothing is thrown.
/// @throws InvalidInput when there is no component, or a log-weight is NaN or +inf
template <LieGroup G>
MergeResult<ConcentratedGaussian<G>> merge(
    std::span<const Component<ConcentratedGaussian<G>>> components,
    const MergeSettings& settings = {});

/// Merges components that do not lie next to each other in memory.
template <LieGroup G>
MergeResult<ConcentratedGaussian<G>> merge(
    std::span<const Component<ConcentratedGaussian<G>>* const> components,
    const MergeSettings& settings = {});

/// Merges projected Gaussians by the same rules. The result is PG_0; covariances are moved by the
/// Jacobian of `change_chart`.
///  - midway: the components are moved to the chart at the rotation where the weighted mean of
///    their modes is zero (`gnomonic_mean`), and the moments of the Gaussians are matched there;
///  - tangent_of_larger: the components are moved to the chart at the mode of the heaviest, the
///    moments of the Gaussians are matched there, and the result is moved to the chart at its mode;
///  - moment_matched: the moments of the distributions are matched (`moments`), which is best for
///    large spreads or distances.
/// @throws InvalidInput when there is no component, a log-weight is NaN or +inf, or with
/// tangent_of_larger when the rotation between a mode and that of the heaviest is by pi
template <RotationOrPose G>
MergeResult<ProjectedGaussian<G>> merge(std::span<const Component<ProjectedGaussian<G>>> components,
                                        const MergeSettings& settings = {});
template <RotationOrPose G>
MergeResult<ProjectedGaussian<G>> merge(
    std::span<const Component<ProjectedGaussian<G>>* const> components,
    const MergeSettings& settings = {});

}  // namespace posemix

#include "posemix/reduction/merge_impl.hpp"
