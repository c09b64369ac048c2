// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "posemix/mixture/tangent_moments.hpp"

namespace posemix {

/// Settings of `moments`.
struct MomentSettings {
  int max_iterations = 100;
  double tolerance = 1e-10;  ///< stop when the mean moves by less than this, or rounding [rad, m]
};

/// Mean and covariance of a mixture on a group.
template <class D>
struct Moments {
  D density;  ///< at the mean, with the covariance of Log(X mean^-1)
  bool converged;
  int iterations;   ///< updates of the mean
  double residual;  ///< |E[Log(X mean^-1)]| [rad, m]
};

namespace internal {

/// First and second moment of Log(X anchor^-1) under one component, by the spherical cubature rule
/// of degree three: 2n points at sqrt(n) standard deviations, exact for polynomials up to degree
/// three in xi.
template <LieGroup G>
struct CubatureMoments {
  typename G::Tangent first;
  typename G::TangentMatrix second;

  CubatureMoments(const ConcentratedGaussian<G>& density, const typename G::TangentMatrix& factor,
                  const G& anchor)
      : first(G::Tangent::Zero(density.dof())),
        second(G::TangentMatrix::Zero(density.dof(), density.dof())) {
    const Eigen::Index n = density.dof();
    const G offset = density.mean() * anchor.inverse();
    const double radius = std::sqrt(static_cast<double>(n));
    for (Eigen::Index column = 0; column < n; ++column) {
      for (const double sign : {-radius, radius}) {
        const typename G::Tangent point = (G::exp(sign * factor.col(column)) * offset).log();
        first += point;
        second.noalias() += point * point.transpose();
      }
    }
    first /= static_cast<double>(2 * n);
    second /= static_cast<double>(2 * n);
  }
};

/// A weighted sum of components with its covariances factorised.
template <LieGroup G>
class SumOfComponents {
 public:
  using Components = std::span<const Component<ConcentratedGaussian<G>>>;

  explicit SumOfComponents(Components components) : components_(components) {
    const double log_total = checked_log_total(components);
    for (const auto& component : components) {
      weights_.push_back(std::exp(component.log_weight - log_total));
      factors_.push_back(
          Eigen::LLT<typename G::TangentMatrix>(component.density.covariance()).matrixL());
    }
  }

  const G& heaviest_mean() const {
    const auto heaviest = std::max_element(weights_.begin(), weights_.end()) - weights_.begin();
    return components_[static_cast<std::size_t>(heaviest)].density.mean();
  }

  /// Adds E[Log(X anchor^-1)] to `first` and E[Log(X anchor^-1) Log(X anchor^-1)^T] to `second`.
  void add_moments(const G& anchor, typename G::Tangent& first,
                   typename G::TangentMatrix& second) const {
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      if (weights_[i] == 0.0) continue;
      const CubatureMoments<G> part(components_[i].density, factors_[i], anchor);
      first += weights_[i] * part.first;
      second += weights_[i] * part.second;
    }
  }

 private:
  Components components_;
  std::vector<double> weights_;
  std::vector<typename G::TangentMatrix> factors_;
};

}  // namespace internal

/// Mean and covariance of a weighted sum of components as a random element of the group: the mean M
/// solves E[Log(X M^-1)] = 0 (the Frechet mean of the bi-invariant metric where there is one), the
/// covariance is E[Log(X M^-1) Log(X M^-1)^T]. The expectations are by cubature, the mean by
/// iteration from the heaviest component. Exact on R^n; commutes with right translations, and with
/// left ones up to the cubature's terms of fourth order. Weights need not be normalised. Not
/// converging is reported, not thrown.
/// @throws InvalidInput when there is no component, a log-weight is NaN or +inf, or all weights are
/// zero
template <LieGroup G>
Moments<ConcentratedGaussian<G>> moments(
    std::span<const Component<ConcentratedGaussian<G>>> components,
    const MomentSettings& settings = {}) {
  require(!components.empty(), "moments: there is no component");
  const internal::SumOfComponents<G> sum(components);
  G mean = sum.heaviest_mean();
  const double tolerance = std::max(settings.tolerance, internal::rounding_step(mean));
  const Eigen::Index n = mean.dof();
  typename G::TangentMatrix covariance = G::TangentMatrix::Zero(n, n);
  typename G::Tangent step = G::Tangent::Zero(n);
  bool converged = false;
  int iteration = 0;
  while (true) {
    step.setZero();
    covariance.setZero();
    sum.add_moments(mean, step, covariance);
    converged = step.norm() < tolerance;
    if (converged || iteration >= settings.max_iterations) break;
    mean = G::exp(step) * mean;
    ++iteration;
  }
  symmetrize(covariance);
  return {ConcentratedGaussian<G>::trusted(mean, covariance), converged, iteration, step.norm()};
}

/// Mean and covariance of a whole mixture.
template <LieGroup G>
Moments<ConcentratedGaussian<G>> moments(const Mixture<ConcentratedGaussian<G>>& mixture,
                                         const MomentSettings& settings = {}) {
  return moments<G>(std::span(mixture.components()), settings);
}

}  // namespace posemix
