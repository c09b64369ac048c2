// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <concepts>
#include <optional>

#include "posemix/base/linear.hpp"
#include "posemix/base/random.hpp"
#include "posemix/density/gnomonic.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {

/// The groups that have projected Gaussians.
template <class G>
concept RotationOrPose = std::same_as<G, SO3d> || std::same_as<G, SE3d>;

/// A projected Gaussian (MPG paper, III-B): y = [u; t] ~ N(mean, P) in the tangent space at the
/// rotation q0, projected to rotations by q = q0 (1, u) / sqrt(1 + u.u) and renormalised. On SO(3)
/// y = u alone.
///
/// u is dimensionless, tan(theta/2) along the axis, in the frame that q0 rotates (a perturbation on
/// the right); t is the translation itself in metres, in the reference frame. Sampling u from the
/// Gaussian and projecting does not give this distribution (`sample_by_projection`): the density of
/// eq. 11 lacks the chart's volume factor.
///
/// Invariants, tested as a list:
///  - the covariance is symmetric positive definite;
///  - q and -q have the same density; it integrates to one over the group;
///  - density(X) = N(y(X); mean, P) / (8 C) with respect to the Haar measure, C from
///    `projected_log_normalizer` (eq. 11 divides by C alone: there the measure is that of the half
///    sphere of quaternions);
///  - the mode is the element at y = mean.
template <RotationOrPose G>
class ProjectedGaussian {
 public:
  using Group = G;
  using Tangent = typename G::Tangent;
  using Covariance = typename G::TangentMatrix;

  /// PG_0: the tangent point is the rotation of `mean`, the mean of u zero and that of t its
  /// translation. @throws InvalidInput when the covariance is not finite, symmetric, positive
  /// definite
  ProjectedGaussian(const G& mean, const Covariance& covariance);
  /// Any tangent point. @throws InvalidInput as above, and when the mean is not finite
  ProjectedGaussian(const SO3d& tangent_point, const Tangent& mean, const Covariance& covariance);

  /// The same without the checks, for results of computations that preserve the invariants.
  static ProjectedGaussian trusted(const G& mean, const Covariance& covariance);
  static ProjectedGaussian trusted(const SO3d& tangent_point, const Tangent& mean,
                                   const Covariance& covariance);

  const SO3d& tangent_point() const { return tangent_point_; }
  /// Mean of y = [u; t].
  const Tangent& tangent_mean() const { return mean_; }
  /// Covariance of y = [u; t].
  const Covariance& covariance() const { return covariance_; }
  /// The element at y = mean, which is the mode.
  G mean() const { return element(mean_); }
  Eigen::Index dof() const { return G::Dof; }
  /// log C over the half sphere (eq. 12).
  double log_normalizer() const { return log_normalizer_; }

  /// The element at y, and y of an element (u infinite or NaN where the rotation is by pi from the
  /// tangent point).
  G element(const Tangent& y) const;
  Tangent coordinates(const G& element) const;

  /// Log of the density with respect to the Haar measure [nats]; -inf where the chart has no point.
  /// For many points build an Evaluator once.
  double log_density(const G& element) const { return Evaluator(*this).log_density(element); }

  /// One draw from the density, by rejection: from the Gaussian or from uniform rotations,
  /// whichever is accepted more often.
  G sample(RandomStream& stream) const;
  /// One draw of y from the Gaussian, projected (MPG paper, IV): not the distribution of eq. 11,
  /// and the wider the covariance, the less so.
  G sample_by_projection(RandomStream& stream) const;

  /// Log density at many points: the covariance is factorised once.
  class Evaluator {
   public:
    explicit Evaluator(const ProjectedGaussian& density);
    double log_density(const G& element) const;

   private:
    SO3d tangent_point_;
    Tangent mean_;
    Covariance inverse_factor_;  ///< L^-1, P = L L^T
    double log_constant_;
  };

 private:
  ProjectedGaussian(const SO3d& tangent_point, const Tangent& mean, const Covariance& covariance,
                    internal::Unchecked tag);

  SO3d tangent_point_;
  Tangent mean_;
  Covariance covariance_;
  double log_normalizer_;
};

/// Mean and covariance of y = [u; t] under the distribution of a projected Gaussian, exact up to
/// the rule of `projected_moments`.
template <RotationOrPose G>
struct DistributionMoments {
  typename G::Tangent mean;
  typename G::TangentMatrix covariance;
  Eigen::Matrix3d rotation;  ///< E[R], R the rotation matrix of the element
};

template <RotationOrPose G>
DistributionMoments<G> moments_of(const ProjectedGaussian<G>& density);

/// The density PG_0 at a tangent point whose distribution has the given moments of y = [u; t]: the
/// maximum-likelihood one of samples with these moments. The mean of u must be zero: the first
/// three entries of `mean` are ignored, and `covariance` is about zero in u.
template <RotationOrPose G>
ProjectedGaussian<G> with_moments(const SO3d& tangent_point, const typename G::Tangent& mean,
                                  const typename G::TangentMatrix& covariance);

/// The density in the tangent space at another rotation, with the Jacobian at the mean (MPG paper,
/// eq. 15-16). First order in u.
/// @throws InvalidInput when the mean is by pi from `tangent_point`
template <RotationOrPose G>
ProjectedGaussian<G> change_chart(const ProjectedGaussian<G>& density, const SO3d& tangent_point);

/// The density with the mode as its tangent point, PG_0.
template <RotationOrPose G>
ProjectedGaussian<G> change_chart_to_mode(const ProjectedGaussian<G>& density) {
  return change_chart(density, gnomonic::project(density.tangent_point(),
                                                 density.tangent_mean().template head<3>()));
}

extern template class ProjectedGaussian<SO3d>;
extern template class ProjectedGaussian<SE3d>;

}  // namespace posemix
