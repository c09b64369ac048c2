// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include "posemix/mixture/tangent_moments.hpp"

namespace posemix {

/// Settings of `moments`.
struct MomentSettings {
  int max_iterations = 100;
  double tolerance = 1e-10;  ///< stop when the mean moves by less than this [rad, m]
};

/// Mean and covariance of a mixture on a group.
template <class D>
struct Moments {
  D density;  ///< at the mean, with the covariance of Log(X mean^-1)
  bool converged;
  int iterations;
  double residual;  ///< norm of the last step of the mean [rad, m]
};

namespace internal {

/// First and second moment of Log(X anchor^-1) under one component, by the spherical cubature rule of degree three:
/// 2n points at sqrt(n) standard deviations, exact for polynomials up to degree three in xi.
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

}  // namespace internal

/// Mean and covariance of a weighted sum of components as a random element of the group: the mean M solves
/// E[Log(X M^-1)] = 0 (the Frechet mean of the bi-invariant metric where there is one), the covariance is
/// E[Log(X M^-1) Log(X M^-1)^T]. The expectations are by cubature, the mean by iteration from the heaviest
/// component. Weights need not be normalised. Not converging is reported, not thrown.
template <LieGroup G>
Moments<ConcentratedGaussian<G>> moments(
    std::span<const Component<ConcentratedGaussian<G>>> components,
    const MomentSettings& settings = {}) {
  const auto heavier = [](const auto& a, const auto& b) { return a.log_weight < b.log_weight; };
  const auto heaviest = std::max_element(components.begin(), components.end(), heavier);
  std::vector<typename G::TangentMatrix> factors;
  std::vector<double> weights;
  double total = 0.0;
  for (const auto& component : components) {
    const Eigen::LLT<typename G::TangentMatrix> factor(component.density.covariance());
    factors.push_back(factor.matrixL());
    weights.push_back(std::exp(component.log_weight - heaviest->log_weight));
    total += weights.back();
  }

  G mean = heaviest->density.mean();
  const Eigen::Index n = mean.dof();
  typename G::TangentMatrix covariance;
  double residual = 0.0;
  bool converged = false;
  int iteration = 0;
  while (!converged && iteration < settings.max_iterations) {
    typename G::Tangent step = G::Tangent::Zero(n);
    covariance = G::TangentMatrix::Zero(n, n);
    for (std::size_t i = 0; i < components.size(); ++i) {
      if (weights[i] == 0.0) continue;
      const internal::CubatureMoments<G> part(components[i].density, factors[i], mean);
      step += weights[i] / total * part.first;
      covariance += weights[i] / total * part.second;
    }
    residual = step.norm();
    converged = residual < settings.tolerance;
    if (!converged) mean = G::exp(step) * mean;
    ++iteration;
  }
  symmetrize(covariance);
  return {ConcentratedGaussian<G>::trusted(mean, covariance), converged, iteration, residual};
}

/// Mean and covariance of a whole mixture.
template <LieGroup G>
Moments<ConcentratedGaussian<G>> moments(const Mixture<ConcentratedGaussian<G>>& mixture,
                                         const MomentSettings& settings = {}) {
  return moments<G>(std::span(mixture.components()), settings);
}

}  // namespace posemix
