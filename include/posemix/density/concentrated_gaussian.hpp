// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <utility>

#include "posemix/base/linear.hpp"
#include "posemix/base/random.hpp"
#include "posemix/lie/concept.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {

/// A Gaussian on a Lie group, concentrated around one mean element:
///   X = Exp(xi) X0,  xi ~ N(0, P).
///
/// The perturbation is on the left, so xi and P are stated in the reference frame (for a pose
/// T_a_b, in frame a), rotation first, in radians and metres. The density is with respect to the
/// bi-invariant (Haar) measure dX = |det J_l(xi)| dxi (midway-merge paper, eq. 4-5; that paper
/// writes Exp(-xi), which for a zero-mean xi is the same distribution).
///
/// Invariants, tested as a list:
///  - the covariance is symmetric positive definite and has the size of the group;
///  - log_density(mean) = -(n log 2 pi + log det P) / 2;
///  - log_density(X) = log_density(X^-1) of inverse(density) (the measure is bi-invariant);
///  - on SO(3) the density integrates to one minus the Gaussian mass beyond |xi| = pi.
template <LieGroup G>
class ConcentratedGaussian {
 public:
  using Group = G;
  using Tangent = typename G::Tangent;
  using Covariance = typename G::TangentMatrix;

  /// @throws InvalidInput when the mean is not finite, or the covariance has the wrong size or is
  /// not finite, symmetric, positive definite
  ConcentratedGaussian(G mean, const Covariance& covariance);

  /// A density whose arguments are not checked, for results of computations that preserve the
  /// invariants.
  static ConcentratedGaussian trusted(G mean, Covariance covariance) {
    return ConcentratedGaussian(std::move(mean), std::move(covariance), internal::Unchecked());
  }

  const G& mean() const { return mean_; }
  /// The covariance of xi in X = Exp(xi) X0, in the reference frame.
  const Covariance& covariance() const { return covariance_; }
  /// The covariance of the right perturbation delta in X = X0 Exp(delta), in the body frame.
  Covariance body_covariance() const;
  Eigen::Index dof() const { return mean_.dof(); }
  /// Moves mean and covariance out; the density must not be used afterwards.
  std::pair<G, Covariance> release() && { return {std::move(mean_), std::move(covariance_)}; }

  /// Log of the density with respect to the Haar measure, in nats. Every call factorises the
  /// covariance; for many points, build an Evaluator once.
  double log_density(const G& element) const;

  /// One draw, Exp(L z) X0 with P = L L^T and z standard normal.
  G sample(RandomStream& stream) const;

  /// Evaluates the log density at many points; the covariance is factorised once.
  class Evaluator {
   public:
    explicit Evaluator(const ConcentratedGaussian& density);

    double log_density(const G& element) const;

   private:
    G inverse_mean_;
    Eigen::LLT<Covariance> factor_;
  };

 private:
  ConcentratedGaussian(G&& mean, Covariance&& covariance, internal::Unchecked /*tag*/)
      : mean_(std::move(mean)), covariance_(std::move(covariance)) {}

  G mean_;
  Covariance covariance_;
};

template <LieGroup G>
ConcentratedGaussian<G>::ConcentratedGaussian(G mean, const Covariance& covariance)
    : mean_(std::move(mean)),
      covariance_(checked_covariance(covariance, mean_.dof(), "covariance")) {
  if (!mean_.log().allFinite()) throw InvalidInput("mean holds a value that is not finite");
}

template <LieGroup G>
typename ConcentratedGaussian<G>::Covariance ConcentratedGaussian<G>::body_covariance() const {
  return mean_.inverse().adjoint_congruence(covariance_);
}

template <LieGroup G>
double ConcentratedGaussian<G>::log_density(const G& element) const {
  return Evaluator(*this).log_density(element);
}

template <LieGroup G>
G ConcentratedGaussian<G>::sample(RandomStream& stream) const {
  Eigen::VectorXd white(dof());
  stream.fill_normal(white);
  const Eigen::LLT<Covariance> factor(covariance_);
  return G::exp(Tangent(factor.matrixL() * white)) * mean_;
}

template <LieGroup G>
ConcentratedGaussian<G>::Evaluator::Evaluator(const ConcentratedGaussian& density)
    : inverse_mean_(density.mean().inverse()), factor_(density.covariance()) {}

template <LieGroup G>
double ConcentratedGaussian<G>::Evaluator::log_density(const G& element) const {
  const Tangent xi = (element * inverse_mean_).log();
  return log_normal(factor_, xi) - G::log_abs_det_left_jacobian(xi);
}

/// A Gaussian in the tangent space at `anchor` whose mean need not be zero:
///   X = Exp(xi) anchor,  xi ~ N(mean, P).
template <LieGroup G>
struct TangentGaussian {
  G anchor;
  typename G::Tangent mean;
  typename G::TangentMatrix covariance;
};

extern template class ConcentratedGaussian<SO3d>;
extern template class ConcentratedGaussian<SE3d>;
extern template class ConcentratedGaussian<PoseStackd>;
extern template class ConcentratedGaussian<Rnd<3>>;

}  // namespace posemix
