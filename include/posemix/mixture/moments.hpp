// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <numbers>
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
  D density;        ///< a density at the mean, with the covariance of Log(X mean^-1)
  bool converged;   ///< false also if a component is too wide for the cubature
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

/// The points of every part of an element by the spherical cubature rule of degree three: the 2n
/// points Exp(+-sqrt(n) L e_c) X0 with P = L L^T, where X0 is the part, n its degrees of freedom
/// and P the covariance of its perturbation xi. The rule is exact for polynomials up to degree
/// three in xi, and its points are as far from X0 however many parts there are.
template <LieGroup G>
class CubaturePoints {
 public:
  using Part = typename decltype(parts_of(std::declval<const G&>()))::value_type;
  /// Tangent vectors in columns, one per point.
  using Tangents = Eigen::Matrix<double, Part::Dof, Eigen::Dynamic>;

  explicit CubaturePoints(const ConcentratedGaussian<G>& density) : density_(&density) {
    Eigen::Index row = 0;
    for (const Part& part : parts_of(density.mean())) {
      const Eigen::Index dof = part.dof();
      const typename Part::TangentMatrix covariance =
          density.covariance().block(row, row, dof, dof);
      factors_.emplace_back(covariance);
      const auto& l = factors_.back().matrixLLT();
      const double radius = std::sqrt(static_cast<double>(dof));
      std::vector<Part>& points = points_.emplace_back();
      points.reserve(static_cast<std::size_t>(2 * dof));
      for (Eigen::Index column = 0; column < dof; ++column) {
        typename Part::Tangent xi = radius * l.col(column);
        xi.head(column).setZero();
        in_chart_ = in_chart_ && rotation_of_tangent<Part>(xi) < std::numbers::pi;
        points.push_back(Part::exp(-xi) * part);
        points.push_back(Part::exp(xi) * part);
      }
      row += dof;
    }
  }

  /// Whether all points are within an angle of pi, so that Log(Exp(xi)) = xi.
  bool in_chart() const { return in_chart_; }

  /// Log(X anchor^-1) of every point, part by part.
  std::vector<Tangents> seen_from(const G& anchor) const {
    std::vector<Tangents> tangents;
    tangents.reserve(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Part inverse = parts_of(anchor)[i].inverse();
      Tangents& of_part =
          tangents.emplace_back(inverse.dof(), static_cast<Eigen::Index>(points_[i].size()));
      for (Eigen::Index k = 0; k < of_part.cols(); ++k) {
        of_part.col(k) = (points_[i][static_cast<std::size_t>(k)] * inverse).log();
      }
    }
    return tangents;
  }

  /// sum += weight E[f f^T] for f = Log(X anchor^-1), in the upper triangle. Within a part by the
  /// points. Between parts i and j by statistical linearisation \cite lefebvre2002comment,
  /// f_i = b_i + A_i xi_i with A_i = E[f_i xi_i^T] P_ii^-1 from the points: b_i b_j^T + A_i P_ij
  /// A_j^T. The sum is positive semidefinite, and exact where f is linear.
  void add_second_moment(const std::vector<Tangents>& f, double weight,
                         typename G::TangentMatrix& sum) const {
    if (f.size() > 1) add_between_parts(f, weight, sum);
    Eigen::Index row = 0;
    for (const Tangents& of_part : f) {
      const Eigen::Index dof = of_part.rows();
      const double share = weight / static_cast<double>(of_part.cols());
      // Eigen takes a matrix of one row for a vector, and reads beyond it.
      if constexpr (Part::Dof == 1) {
        sum(row, row) += share * of_part.squaredNorm();
      } else {
        sum.block(row, row, dof, dof)
            .template selfadjointView<Eigen::Upper>()
            .rankUpdate(of_part, share);
      }
      row += dof;
    }
  }

 private:
  template <class P>
  static double rotation_of_tangent(const typename P::Tangent& xi) {
    if constexpr (std::same_as<P, SO3d> || std::same_as<P, SE3d>) {
      return xi.template head<3>().norm();
    } else {
      return 0.0;
    }
  }

  /// A_i of every part: with the points in pairs -+c, E[f xi^T] = sqrt(n) / 2n D L^T for the
  /// differences D of the pairs.
  std::vector<typename Part::TangentMatrix> linearised(const std::vector<Tangents>& f) const {
    std::vector<typename Part::TangentMatrix> slopes;
    slopes.reserve(f.size());
    for (std::size_t i = 0; i < f.size(); ++i) {
      const Eigen::Index dof = f[i].rows();
      typename Part::TangentMatrix differences(dof, dof);
      for (Eigen::Index c = 0; c < dof; ++c)
        differences.col(c) = f[i].col(2 * c + 1) - f[i].col(2 * c);
      const double factor = 0.5 / std::sqrt(static_cast<double>(dof));
      slopes.push_back(factor * factors_[i]
                                    .matrixU()
                                    .solve(typename Part::TangentMatrix(differences.transpose()))
                                    .transpose());
    }
    return slopes;
  }

  void add_between_parts(const std::vector<Tangents>& f, double weight,
                         typename G::TangentMatrix& sum) const {
    const std::vector<typename Part::TangentMatrix> slopes = linearised(f);
    Eigen::Index column = 0;
    for (std::size_t j = 0; j < f.size(); ++j) {
      const Eigen::Index width = f[j].rows();
      const typename Part::Tangent b_j = weight * f[j].rowwise().mean();
      Eigen::Index row = 0;
      for (std::size_t i = 0; i < j; ++i) {
        const Eigen::Index height = f[i].rows();
        const typename Part::TangentMatrix p =
            density_->covariance().block(row, column, height, width);
        sum.block(row, column, height, width) += weight * (slopes[i] * p * slopes[j].transpose()) +
                                                 f[i].rowwise().mean() * b_j.transpose();
        row += height;
      }
      column += width;
    }
  }

  const ConcentratedGaussian<G>* density_;
  std::vector<Eigen::LLT<typename Part::TangentMatrix>> factors_;
  std::vector<std::vector<Part>> points_;
  bool in_chart_ = true;
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
  std::vector<std::vector<typename CubaturePoints<G>::Tangents>> tangents(points.size());
  typename G::Tangent step = G::Tangent::Zero(n);
  bool converged = false;
  int iteration = 0;
  while (true) {
    step.setZero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      tangents[i] = points[i].seen_from(mean);
      Eigen::Index row = 0;
      for (const auto& of_part : tangents[i]) {
        step.segment(row, of_part.rows()) += weights[i] * of_part.rowwise().mean();
        row += of_part.rows();
      }
    }
    converged = step.norm() < tolerance;
    if (converged || iteration >= settings.max_iterations) break;
    mean = G::exp(step) * mean;
    ++iteration;
  }
  typename G::TangentMatrix covariance = G::TangentMatrix::Zero(n, n);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].add_second_moment(tangents[i], weights[i], covariance);
    converged = converged && points[i].in_chart();
  }
  covariance = mirror_upper(covariance);
  return {ConcentratedGaussian<G>::trusted(mean, covariance), converged, iteration, step.norm()};
}

}  // namespace internal

/// Mean and covariance of a weighted sum of components as a random element of the group. The mean M
/// solves E[Log(X M^-1)] = 0 (the Frechet mean of the bi-invariant metric if there is one); the
/// covariance is E[Log(X M^-1) Log(X M^-1)^T]. The expectations are by cubature, on a stack of
/// poses pose by pose, with covariances between poses by statistical linearisation; the mean is by
/// iteration from the heaviest component. Exact on R^n; commutes with right translations, and with
/// left translations up to the cubature's error of fourth order. Weights need not be normalised.
///
/// The cubature's points are at sqrt(n) standard deviations, n = 3 for a rotation and 6 for a pose,
/// of which a stack may have any number. They must be within an angle of pi, which they are up to a
/// standard deviation of 103 degrees of a rotation and 73 degrees of a pose. If they are not, or
/// the iteration does not converge, `converged` is false; nothing is thrown.
/// @throws InvalidInput when there is no component, a log-weight is NaN or +inf, or all weights are
/// zero
template <LieGroup G>
Moments<ConcentratedGaussian<G>> moments(
    std::span<const Component<ConcentratedGaussian<G>>> components,
    const MomentSettings& settings = {}) {
  require(!components.empty(), "moments: there is no component");
  const internal::LogScale scale = internal::checked_log_scale(components);
  std::vector<double> weights;
  std::vector<const ConcentratedGaussian<G>*> densities;
  for (const auto& component : components) {
    const double weight = std::exp(scale(component.log_weight));
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
