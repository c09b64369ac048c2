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

/// The groups on which projected Gaussians are defined.
template <class G>
concept RotationOrPose = std::same_as<G, SO3d> || std::same_as<G, SE3d>;

/// A projected Gaussian (MPG paper, III-B): y = [u; t] ~ N(mean, P) in the tangent space at the
/// rotation q0, projected to rotations by q = q0 (1, u) / sqrt(1 + u.u) and renormalised. On SO(3),
/// y is u alone.
///
/// u is dimensionless, tan(theta/2) along the axis, in the frame that q0 rotates (a perturbation on
/// the right); t is the translation itself in metres, in the reference frame. Sampling u from the
/// Gaussian and projecting does not give this distribution (`sample_by_projection`): the density of
/// eq. 11 lacks the chart's volume factor.
///
/// Invariants, tested as a list:
///  - the covariance is symmetric positive definite;
///  - q and -q have the same density; it integrates to one over the group;
///  - density(X) = N(y(X); mean, P) / (8 C) with respect to the Haar measure, with C from
///    `projected_log_normalizer` (eq. 11 divides by C alone, because its measure is that of the
///    half sphere of quaternions);
///  - the mode is the element at y = mean.
template <RotationOrPose G>
class ProjectedGaussian {
 public:
  using Group = G;
  using Tangent = typename G::Tangent;
  using Covariance = typename G::TangentMatrix;

  /// The density PG_0, whose tangent point is the rotation of `mean`: the mean of u is zero and the
  /// mean of t is the translation of `mean`.
  /// @throws InvalidInput when the covariance is not finite, symmetric, positive definite, or the
  /// mean is not finite
  ProjectedGaussian(const G& mean, const Covariance& covariance);
  /// A density with any tangent point; `mean` is the mean of y = [u; t].
  /// @throws InvalidInput when the covariance is not finite, symmetric, positive definite, or the
  /// mean is not finite
  ProjectedGaussian(const SO3d& tangent_point, const Tangent& mean, const Covariance& covariance);

  /// Densities whose arguments are not checked, for results of computations that preserve the
  /// invariants.
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
  /// log C, with C taken over the half sphere of quaternions (eq. 12).
  double log_normalizer() const { return log_normalizer_; }

  /// The element with coordinates y.
  G element(const Tangent& y) const;
  /// The coordinates y of an element; u is infinite or NaN if the rotation is by pi from the
  /// tangent point.
  Tangent coordinates(const G& element) const;

  /// Log of the density with respect to the Haar measure [nats]; -inf for an element that has no
  /// coordinates. For many points, build an Evaluator once.
  double log_density(const G& element) const { return Evaluator(*this).log_density(element); }

  /// One draw from the density by rejection sampling. Proposals are from the Gaussian or uniform
  /// rotations, whichever have the higher acceptance rate.
  G sample(RandomStream& stream) const;
  /// One draw of y from the Gaussian, projected (MPG paper, IV). Its distribution is not that of
  /// eq. 11; they differ the more, the wider the covariance is.
  G sample_by_projection(RandomStream& stream) const;

  /// Evaluates the log density at many points; the covariance is factorised once.
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
/// the quadrature error of `projected_moments`.
template <RotationOrPose G>
struct DistributionMoments {
  typename G::Tangent mean;
  typename G::TangentMatrix covariance;
  Eigen::Matrix3d rotation;  ///< E[R], R the rotation matrix of the element
};

/// The moments of the distribution of a projected Gaussian.
template <RotationOrPose G>
DistributionMoments<G> moments_of(const ProjectedGaussian<G>& density);

/// The density PG_0 at a tangent point whose distribution has the given moments of y = [u; t]; it
/// is the maximum-likelihood fit to samples with these moments. The mean of u must be zero: the
/// first three entries of `mean` are ignored, and `covariance` is about zero in u.
template <RotationOrPose G>
ProjectedGaussian<G> with_moments(const SO3d& tangent_point, const typename G::Tangent& mean,
                                  const typename G::TangentMatrix& covariance);

/// The density in the chart at another tangent point, by the Jacobian at the mean (MPG paper, eq.
/// 15-16). First order in u.
/// @throws InvalidInput when the rotation from `tangent_point` to the mean is by pi
template <RotationOrPose G>
ProjectedGaussian<G> change_chart(const ProjectedGaussian<G>& density, const SO3d& tangent_point);

/// The density in the chart at its own mode, PG_0.
template <RotationOrPose G>
ProjectedGaussian<G> change_chart_to_mode(const ProjectedGaussian<G>& density) {
  return change_chart(density, gnomonic::project(density.tangent_point(),
                                                 density.tangent_mean().template head<3>()));
}

extern template class ProjectedGaussian<SO3d>;
extern template class ProjectedGaussian<SE3d>;

}  // namespace posemix
