// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include "posemix/divergence/gaussian.hpp"
#include "posemix/mixture/operations.hpp"

/// Wasserstein distances between densities and between mixtures. As for gaussian_kl, two densities
/// are compared in the tangent space at the midpoint of their means: first order on a curved group,
/// exact on R^n.
///
/// A length scale s [m/rad] weighs radians against metres: the squared length of a tangent vector
/// is s^2 |phi|^2 + |rho|^2, and distances are in metres. On SO(3) a scale of 1 gives radians; on
/// R^n the scale has no effect.
namespace posemix {

namespace internal {

/// W2^2 of N(0, P) and N(d, Q): |d|^2 + tr(P + Q - 2 (P^1/2 Q P^1/2)^1/2).
double squared_wasserstein(const Eigen::VectorXd& d, const Eigen::MatrixXd& p,
                           const Eigen::MatrixXd& q);

/// The least sum_ij T_ij cost_ij over all T >= 0 with the given row and column sums, which are
/// equal in total.
double transport_cost(const Eigen::VectorXd& rows, const Eigen::VectorXd& columns,
                      const Eigen::MatrixXd& cost);

/// The factors that turn tangent coordinates into metres.
template <LieGroup G>
Eigen::VectorXd metric_scale(Eigen::Index n, double length_scale) {
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(n);
  if constexpr (std::is_same_v<G, SO3<typename G::Scalar>>) {
    scale.setConstant(length_scale);
  } else if constexpr (!requires(G g) { g.value(); }) {
    for (Eigen::Index i = 0; i + 6 <= n; i += 6) scale.segment(i, 3).setConstant(length_scale);
  }
  return scale;
}

template <LieGroup G>
double squared_wasserstein(const ConcentratedGaussian<G>& p, const ConcentratedGaussian<G>& q,
                           double length_scale) {
  if (p.dof() != q.dof()) {
    throw InvalidInput(fmt::format("densities of {} and {} degrees of freedom", p.dof(), q.dof()));
  }
  if (!(length_scale > 0.0) || !std::isfinite(length_scale)) {
    throw InvalidInput(
        fmt::format("length_scale is {}, expected a finite number > 0", length_scale));
  }
  const CommonTangent<G> at(p, q, interpolate(p.mean(), q.mean(), 0.5));
  const Eigen::VectorXd scale = metric_scale<G>(p.dof(), length_scale);
  const auto scaled = [&](const typename G::TangentMatrix& covariance) -> Eigen::MatrixXd {
    return scale.asDiagonal() * covariance * scale.asDiagonal();
  };
  const Eigen::VectorXd d = scale.cwiseProduct(at.q.mean - at.p.mean);
  return squared_wasserstein(d, scaled(at.p.covariance), scaled(at.q.covariance));
}

}  // namespace internal

/// The 2-Wasserstein distance W2 of two densities, sqrt(|d|^2 + tr(P + Q - 2 (P^1/2 Q P^1/2)^1/2)).
/// @throws InvalidInput when sizes differ or the length scale [m/rad] is not positive
template <LieGroup G>
double gaussian_wasserstein(const ConcentratedGaussian<G>& p, const ConcentratedGaussian<G>& q,
                            double length_scale = 1.0) {
  return std::sqrt(internal::squared_wasserstein(p, q, length_scale));
}

/// The mixture-Wasserstein distance MW2 (\cite delon2020wasserstein): the square root of the least
/// cost of moving the weights of the components of p onto those of q, where the cost of moving a
/// unit of weight is the W2^2 of the two components. An upper bound of W2 on R^n. The transport
/// problem is solved exactly for weights rounded to 2^-40 and costs rounded to 2^-40 of the
/// largest.
/// @throws InvalidInput when sizes differ, the length scale [m/rad] is not positive, or a cost is
/// 1e300 or more
template <LieGroup G>
double mixture_wasserstein(const Mixture<ConcentratedGaussian<G>>& p,
                           const Mixture<ConcentratedGaussian<G>>& q, double length_scale = 1.0) {
  const auto rows = static_cast<Eigen::Index>(p.size());
  const auto columns = static_cast<Eigen::Index>(q.size());
  Eigen::VectorXd p_weights(rows);
  Eigen::VectorXd q_weights(columns);
  Eigen::MatrixXd cost(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) p_weights[i] = p.weight(static_cast<std::size_t>(i));
  for (Eigen::Index j = 0; j < columns; ++j) q_weights[j] = q.weight(static_cast<std::size_t>(j));
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      cost(i, j) =
          internal::squared_wasserstein(p[static_cast<std::size_t>(i)].density,
                                        q[static_cast<std::size_t>(j)].density, length_scale);
    }
  }
  return std::sqrt(internal::transport_cost(p_weights, q_weights, cost));
}

// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_WASSERSTEIN(prefix, G)                                                 \
  prefix template double gaussian_wasserstein(const ConcentratedGaussian<G>&,          \
                                              const ConcentratedGaussian<G>&, double); \
  prefix template double mixture_wasserstein(const Mixture<ConcentratedGaussian<G>>&,  \
                                             const Mixture<ConcentratedGaussian<G>>&, double)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_WASSERSTEIN(extern, SO3d);
POSEMIX_WASSERSTEIN(extern, SE3d);
POSEMIX_WASSERSTEIN(extern, PoseStackd);
POSEMIX_WASSERSTEIN(extern, Rnd<3>);

}  // namespace posemix
