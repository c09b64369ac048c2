// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "posemix/mixture/tangent_moments.hpp"

namespace posemix {

/// Settings of `moments`.
struct MomentSettings {
  int max_iterations = 100;
  /// Stop when the mean moves by less than this, or than rounding [rad, m].
  double tolerance = 1e-10;
};

/// The mean and covariance of a mixture on a group.
template <class D>
struct Moments {
  D density;  ///< a density at the mean, with the covariance of Log(X mean^-1)
  bool converged;
  int iterations;   ///< updates of the mean
  double residual;  ///< |E[Log(X mean^-1)]| [rad, m]
};

namespace internal {

/// The parts of an element: the poses of a stack, otherwise the element itself.
template <LieGroup G>
std::span<const G> parts_of(const G& element) {
  return {&element, 1};
}
inline std::span<const SE3d> parts_of(const PoseStackd& stack) { return stack.poses(); }

/// The 2n points Exp(+-sqrt(n) L e_c) X0 with P = L L^T of the spherical cubature rule of degree
/// three, which is exact for polynomials up to degree three in xi. L is lower triangular, so column
/// c moves only the part of X that c belongs to and the parts after it; points of a part that does
/// not move are not stored.
template <LieGroup G>
class CubaturePoints {
 public:
  using Part = typename decltype(parts_of(std::declval<const G&>()))::value_type;
  /// Tangent vectors in columns, one per point.
  using Tangents = Eigen::Matrix<double, G::Dof, Eigen::Dynamic>;

  explicit CubaturePoints(const ConcentratedGaussian<G>& density)
      : size_(2 * density.dof()), mean_(&density.mean()) {
    const Eigen::Index n = density.dof();
    const Eigen::LLT<typename G::TangentMatrix> factor(density.covariance());
    const auto& l = factor.matrixLLT();
    const double radius = std::sqrt(static_cast<double>(n));
    Eigen::Index row = 0;
    for (const Part& part : parts_of(density.mean())) {
      const Eigen::Index dof = part.dof();
      std::vector<Part>& points = points_.emplace_back();
      points.reserve(static_cast<std::size_t>(2 * (row + dof)));
      for (Eigen::Index column = 0; column < row + dof; ++column) {
        typename Part::Tangent xi = radius * l.col(column).segment(row, dof);
        if (column > row) xi.head(column - row).setZero();
        points.push_back(Part::exp(-xi) * part);
        points.push_back(Part::exp(xi) * part);
      }
      row += dof;
    }
  }

  /// Log(X anchor^-1) of every point.
  Tangents seen_from(const G& anchor) const {
    Tangents tangents(anchor.dof(), size_);
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Part inverse = parts_of(anchor)[i].inverse();
      const Eigen::Index dof = inverse.dof();
      const auto moved = static_cast<Eigen::Index>(points_[i].size());
      for (Eigen::Index k = 0; k < moved; ++k) {
        tangents.col(k).segment(row, dof) =
            (points_[i][static_cast<std::size_t>(k)] * inverse).log();
      }
      const typename Part::Tangent still = (parts_of(*mean_)[i] * inverse).log();
      tangents.block(row, moved, dof, size_ - moved).colwise() = still;
      row += dof;
    }
    return tangents;
  }

 private:
  Eigen::Index size_;
  const G* mean_;
  std::vector<std::vector<Part>> points_;  ///< the moved points of every part
};

/// The moments of a sum of densities with weights that sum to one.
template <LieGroup G>
Moments<ConcentratedGaussian<G>> moments_of(
    std::span<const double> weights, std::span<const ConcentratedGaussian<G>* const> densities,
    const MomentSettings& settings) {
  const auto heaviest = std::max_element(weights.begin(), weights.end()) - weights.begin();
  G mean = densities[static_cast<std::size_t>(heaviest)]->mean();
  const double tolerance = std::max(settings.tolerance, rounding_step(mean));
  const Eigen::Index n = mean.dof();
  std::vector<CubaturePoints<G>> points;
  points.reserve(densities.size());
  for (const auto* density : densities) points.emplace_back(*density);
  std::vector<typename CubaturePoints<G>::Tangents> tangents(points.size());
  typename G::Tangent step = G::Tangent::Zero(n);
  bool converged = false;
  int iteration = 0;
  while (true) {
    step.setZero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      tangents[i] = points[i].seen_from(mean);
      step += weights[i] * tangents[i].rowwise().mean();
    }
    converged = step.norm() < tolerance;
    if (converged || iteration >= settings.max_iterations) break;
    mean = G::exp(step) * mean;
    ++iteration;
  }
  typename G::TangentMatrix covariance = G::TangentMatrix::Zero(n, n);
  for (std::size_t i = 0; i < points.size(); ++i) {
    covariance.template selfadjointView<Eigen::Upper>().rankUpdate(
        tangents[i], weights[i] / static_cast<double>(2 * n));
  }
  covariance = mirror_upper(covariance);
  return {ConcentratedGaussian<G>::trusted(mean, covariance), converged, iteration, step.norm()};
}

}  // namespace internal

/// Mean and covariance of a weighted sum of components as a random element of the group. The mean M
/// solves E[Log(X M^-1)] = 0 (the Frechet mean of the bi-invariant metric if there is one); the
/// covariance is E[Log(X M^-1) Log(X M^-1)^T]. The expectations are by cubature, the mean by
/// iteration from the heaviest component. Exact on R^n; commutes with right translations, and with
/// left translations up to the cubature's error of fourth order. Weights need not be normalised. If
/// the iteration does not converge, `converged` is false; nothing is thrown.
/// @throws InvalidInput when there is no component, a log-weight is NaN or +inf, or all weights are
/// zero
template <LieGroup G>
Moments<ConcentratedGaussian<G>> moments(
    std::span<const Component<ConcentratedGaussian<G>>> components,
    const MomentSettings& settings = {}) {
  require(!components.empty(), "moments: there is no component");
  const double log_total = checked_log_total(components);
  std::vector<double> weights;
  std::vector<const ConcentratedGaussian<G>*> densities;
  for (const auto& component : components) {
    const double weight = std::exp(component.log_weight - log_total);
    if (weight == 0.0) continue;
    weights.push_back(weight);
    densities.push_back(&component.density);
  }
  return internal::moments_of<G>(weights, densities, settings);
}

/// Mean and covariance of a whole mixture.
template <LieGroup G>
Moments<ConcentratedGaussian<G>> moments(const Mixture<ConcentratedGaussian<G>>& mixture,
                                         const MomentSettings& settings = {}) {
  return moments<G>(std::span(mixture.components()), settings);
}

// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_MOMENTS(prefix, G)                                                 \
  prefix template Moments<ConcentratedGaussian<G>> internal::moments_of(           \
      std::span<const double>, std::span<const ConcentratedGaussian<G>* const>,    \
      const MomentSettings&);                                                      \
  prefix template Moments<ConcentratedGaussian<G>> moments(                        \
      std::span<const Component<ConcentratedGaussian<G>>>, const MomentSettings&); \
  prefix template Moments<ConcentratedGaussian<G>> moments(                        \
      const Mixture<ConcentratedGaussian<G>>&, const MomentSettings&)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_MOMENTS(extern, SO3d);
POSEMIX_MOMENTS(extern, SE3d);
POSEMIX_MOMENTS(extern, PoseStackd);
POSEMIX_MOMENTS(extern, Rnd<3>);

}  // namespace posemix
