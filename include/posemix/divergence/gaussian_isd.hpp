// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/mixture/mixture.hpp"
#include "posemix/mixture/operations.hpp"

namespace posemix {

/// Integral square distance int (p - q)^2 dx of two Gaussian mixtures on R^n, exact: sum_ij c_i c_j
/// N(m_i - m_j; 0, P_i + P_j) over all components, with c = w for the components of p and c = -w
/// for those of q. The absolute error is 1e-15 times the largest term.
/// @throws InvalidInput when sizes differ
template <int N>
double gaussian_isd(const Mixture<ConcentratedGaussian<Rnd<N>>>& p,
                    const Mixture<ConcentratedGaussian<Rnd<N>>>& q) {
  using Matrix = typename Rnd<N>::TangentMatrix;
  if (p.dof() != q.dof()) {
    throw InvalidInput(fmt::format("mixtures of {} and {} degrees of freedom", p.dof(), q.dof()));
  }
  const auto overlap = [](const auto& a, const auto& b) {
    double sum = 0.0;
    for (const auto& i : a.components()) {
      for (const auto& j : b.components()) {
        const Eigen::LLT<Matrix> factor(i.density.covariance() + j.density.covariance());
        const typename Rnd<N>::Tangent d = i.density.mean().value() - j.density.mean().value();
        sum += std::exp(i.log_weight + j.log_weight + log_normal(factor, d));
      }
    }
    return sum;
  };
  return overlap(p, p) - 2.0 * overlap(p, q) + overlap(q, q);
}

}  // namespace posemix
