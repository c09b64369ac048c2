// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/divergence/gaussian.hpp"
#include "posemix/divergence/projected.hpp"
#include "posemix/mixture/moments.hpp"
#include "posemix/reduction/pair_table.hpp"

namespace posemix {

/// The rule by which the next two components to be merged are chosen.
enum class PairRule {
  largest_with_smallest,  ///< by weight, the rule of the midway paper
  /// The largest distance between means, as in the simulation of the midway paper.
  most_distant,
  /// The smallest of Runnalls' bounds on the divergence that the merge causes.
  runnalls,
  symmetric_kl,  ///< the smallest symmetric Kullback-Leibler divergence
  /// The smallest symmetric Kullback-Leibler divergence times w_a w_b / (w_a + w_b), which is to
  /// second order the divergence that the merge causes (MPG paper, eq. 23 and 24).
  weighted_symmetric_kl
};

/// The words of PairRule in files and options.
template <>
inline constexpr WordTable<PairRule, 5> words<PairRule>{{
    {"largest_with_smallest", PairRule::largest_with_smallest},
    {"most_distant", PairRule::most_distant},
    {"runnalls", PairRule::runnalls},
    {"symmetric_kl", PairRule::symmetric_kl},
    {"weighted_symmetric_kl", PairRule::weighted_symmetric_kl},
}};

/// The distance between two means, with d = Log(X_b X_a^-1).
enum class DistanceMetric {
  /// |d| over all coordinates, radians and metres alike (|dx| in the midway paper, eq. 16).
  tangent_norm,
  rotation,     ///< norm of the rotation coordinates [rad]
  translation,  ///< norm of the translation coordinates [m]
  mahalanobis   ///< sqrt(d^T (P_a + P_b)^-1 d)
};

/// The words of DistanceMetric in files and options.
template <>
inline constexpr WordTable<DistanceMetric, 4> words<DistanceMetric>{{
    {"tangent_norm", DistanceMetric::tangent_norm},
    {"rotation", DistanceMetric::rotation},
    {"translation", DistanceMetric::translation},
    {"mahalanobis", DistanceMetric::mahalanobis},
}};

namespace internal {

/// Squared norms of the rotation and the translation coordinates of a tangent vector.
struct SquaredNorms {
  double rotation = 0.0;
  double translation = 0.0;
};

/// The squared norms of Log T, without computing the logarithm. J_l^-1(phi) keeps the component
/// along the axis of the rotation by theta and stretches the others by h = (theta/2) /
/// sin(theta/2), so that
///   |J_l^-1(phi) t|^2 = h^2 |t|^2 - (h^2 - 1) (axis . t)^2.
inline SquaredNorms squared_norms_of_log(const SE3d& pose) {
  const Eigen::Vector3d sine = pose.rotation().quaternion().vec();  // sin(theta/2) axis
  const Eigen::Vector3d& t = pose.translation();
  const double sine_squared = sine.squaredNorm();
  if (sine_squared < std::numeric_limits<double>::min()) return {0.0, t.squaredNorm()};
  const double half_angle =
      std::atan2(std::sqrt(sine_squared), std::abs(pose.rotation().quaternion().w()));
  const double stretch = half_angle * half_angle / sine_squared;
  const double along = sine.dot(t);
  return {4.0 * half_angle * half_angle,
          stretch * t.squaredNorm() - (stretch - 1.0) * along * along / sine_squared};
}

/// The distance of two elements: the norm of Log(b a^-1) over the coordinates of the metric.
template <LieGroup G>
double log_distance(const G& a, const G& b, DistanceMetric metric) {
  if constexpr (std::same_as<G, SE3d> || std::same_as<G, PoseStackd>) {
    SquaredNorms sum;
    const std::span<const SE3d> from = parts_of(a);
    const std::span<const SE3d> to = parts_of(b);
    for (std::size_t i = 0; i < from.size(); ++i) {
      const SquaredNorms one = squared_norms_of_log(to[i] * from[i].inverse());
      sum.rotation += one.rotation;
      sum.translation += one.translation;
    }
    if (metric == DistanceMetric::rotation) return std::sqrt(sum.rotation);
    if (metric == DistanceMetric::translation) return std::sqrt(sum.translation);
    return std::sqrt(sum.rotation + sum.translation);
  } else {
    return (b * a.inverse()).log().norm();
  }
}

}  // namespace internal

/// The distance between the means of two densities. On a group without poses (SO(3), R^n), the
/// metrics rotation and translation are the tangent norm.
template <LieGroup G>
double distance(const ConcentratedGaussian<G>& a, const ConcentratedGaussian<G>& b,
                DistanceMetric metric) {
  switch (metric) {
    case DistanceMetric::tangent_norm:
    case DistanceMetric::rotation:
    case DistanceMetric::translation:
      return internal::log_distance(a.mean(), b.mean(), metric);
    case DistanceMetric::mahalanobis: {
      const typename G::Tangent d = (b.mean() * a.mean().inverse()).log();
      const Eigen::LLT<typename G::TangentMatrix> sum(a.covariance() + b.covariance());
      return sum.matrixL().solve(d).norm();
    }
  }
  throw InvalidInput("distance: unknown metric");
}

/// The distance between the modes of two projected Gaussians; the Mahalanobis distance is in the
/// tangent space halfway.
template <RotationOrPose G>
double distance(const ProjectedGaussian<G>& a, const ProjectedGaussian<G>& b,
                DistanceMetric metric) {
  if (metric == DistanceMetric::mahalanobis) return mahalanobis_distance(a, b);
  return internal::log_distance(a.mean(), b.mean(), metric);
}

/// w_a w_b / (w_a + w_b) times the symmetric Kullback-Leibler divergence of the densities, with w =
/// exp(log_weight); zero if one of the weights is zero.
template <class D>
double weighted_symmetric_kl(const Component<D>& a, const Component<D>& b) {
  const double w_a = std::exp(a.log_weight);
  const double w_b = std::exp(b.log_weight);
  if (w_a == 0.0 || w_b == 0.0) return 0.0;
  return w_a / (w_a + w_b) * w_b * gaussian_symmetric_kl(a.density, b.density);
}

/// Chooses pairs while a list of components shrinks. The costs of pairs that a merge does not touch
/// are kept.
template <class D>
class PairSelector {
 public:
  using Components = std::vector<Component<D>>;

  PairSelector(const Components& components, PairRule rule, DistanceMetric metric);

  /// The next pair (a, b), a < b. Among equal costs, the pair that is first in order of a, then b.
  /// By weight, the first of the largest and the last of the smallest, so that with equal weights a
  /// component is never paired with itself.
  std::pair<std::size_t, std::size_t> next(const Components& components) const;

  /// Updates the costs after a merge: component a is the merge of a and b, and b was erased.
  void merged(const Components& components, std::size_t a, std::size_t b);

 private:
  /// Whether costs are computed by vector instructions.
  static constexpr bool kByColumns = std::same_as<D, ConcentratedGaussian<SE3d>>;

  static std::pair<std::size_t, std::size_t> extreme_weights(const Components& components);
  double cost(const Component<D>& a, const Component<D>& b) const;
  /// costs_ becomes that of the pairs of component `i` with the first `count`, by their slots.
  void find_costs(const Components& components, std::size_t i, std::size_t count);

  PairRule rule_;
  DistanceMetric metric_;
  internal::PairTable table_;
  internal::ComponentColumns columns_;
  std::vector<double> costs_;
};

template <class D>
PairSelector<D>::PairSelector(const Components& components, PairRule rule, DistanceMetric metric)
    : rule_(rule), metric_(metric) {
  if (rule_ == PairRule::largest_with_smallest) return;
  table_ = internal::PairTable(components.size());
  costs_.resize(components.size() + internal::ComponentColumns::kRoom);
  if constexpr (kByColumns) {
    columns_ = internal::ComponentColumns(components.size());
    for (std::size_t i = 0; i < components.size(); ++i) columns_.set(i, components[i]);
  }
  for (std::size_t row = 1; row < components.size(); ++row) {
    find_costs(components, row, row);
    table_.set_before(row, costs_.data());
  }
}

template <class D>
void PairSelector<D>::find_costs(const Components& components, std::size_t i, std::size_t count) {
  const std::vector<std::size_t>& slots = table_.slots();
  if constexpr (kByColumns) {
    if (count > 0) columns_.costs(rule_, metric_, slots[i], slots[count - 1] + 1, costs_.data());
  } else {
    for (std::size_t k = 0; k < count; ++k) {
      if (k == i) continue;
      const auto [column, row] = std::minmax(i, k);
      costs_[slots[k]] = cost(components[row], components[column]);
    }
  }
}

template <class D>
std::pair<std::size_t, std::size_t> PairSelector<D>::next(const Components& components) const {
  return rule_ == PairRule::largest_with_smallest ? extreme_weights(components) : table_.least();
}

template <class D>
void PairSelector<D>::merged(const Components& components, std::size_t a, std::size_t b) {
  if (rule_ == PairRule::largest_with_smallest) return;
  const std::vector<std::size_t> before = table_.slots();
  const bool renumbered = table_.erase(b);
  if constexpr (kByColumns) {
    if (renumbered) {
      std::vector<std::size_t> left = before;
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(b));
      columns_.renumber(left);
    }
    columns_.set(table_.slots()[a], components[a]);
  }
  find_costs(components, a, components.size());
  table_.set_all(a, costs_.data());
}

template <class D>
std::pair<std::size_t, std::size_t> PairSelector<D>::extreme_weights(const Components& components) {
  std::size_t largest = 0;
  std::size_t smallest = 0;
  for (std::size_t i = 1; i < components.size(); ++i) {
    if (components[i].log_weight > components[largest].log_weight) largest = i;
    if (components[i].log_weight <= components[smallest].log_weight) smallest = i;
  }
  return std::minmax(largest, smallest);
}

template <class D>
double PairSelector<D>::cost(const Component<D>& a, const Component<D>& b) const {
  switch (rule_) {
    case PairRule::most_distant:
      return -distance(a.density, b.density, metric_);
    case PairRule::runnalls:
      return runnalls_bound(a, b);
    case PairRule::symmetric_kl:
      return gaussian_symmetric_kl(a.density, b.density);
    case PairRule::weighted_symmetric_kl:
      return weighted_symmetric_kl(a, b);
    case PairRule::largest_with_smallest:
      break;
  }
  throw InvalidInput("reduce: unknown pair rule");
}

// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_PAIR(prefix, G)                                                                   \
  prefix template double distance(const ConcentratedGaussian<G>&, const ConcentratedGaussian<G>&, \
                                  DistanceMetric);                                                \
  prefix template double weighted_symmetric_kl(const Component<ConcentratedGaussian<G>>&,         \
                                               const Component<ConcentratedGaussian<G>>&);        \
  prefix template class PairSelector<ConcentratedGaussian<G>>
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_PAIR(extern, SO3d);
POSEMIX_PAIR(extern, SE3d);
POSEMIX_PAIR(extern, PoseStackd);
POSEMIX_PAIR(extern, Rnd<3>);

}  // namespace posemix
