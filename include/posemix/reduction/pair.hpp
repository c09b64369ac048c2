// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <concepts>
#include <limits>
#include <utility>
#include <vector>

#include "posemix/divergence/gaussian.hpp"

namespace posemix {

/// Which two components are merged next.
enum class PairRule {
  largest_with_smallest,  ///< by weight, the midway paper's rule
  most_distant,           ///< the largest distance between means, the midway paper's simulation
  runnalls,               ///< the smallest of Runnalls' bounds on the divergence caused
  symmetric_kl            ///< the smallest symmetric Kullback-Leibler divergence
};

/// What "distant" means, d = Log(X_b X_a^-1).
enum class DistanceMetric {
  tangent_norm,  ///< |d| over all coordinates, radians and metres alike (the midway paper's |dx|,
                 ///< eq. 16)
  rotation,      ///< norm of the rotation coordinates [rad]
  translation,   ///< norm of the translation coordinates [m]
  mahalanobis    ///< sqrt(d^T (P_a + P_b)^-1 d)
};

namespace internal {

template <class G>
inline constexpr bool kHasPoses = std::same_as<G, SE3d> || std::same_as<G, PoseStackd>;

/// Norm over the rotation (part 0) or translation (part 1) coordinates of all poses.
template <LieGroup G>
double part_norm(const typename G::Tangent& d, Eigen::Index part) {
  if constexpr (!kHasPoses<G>) return d.norm();
  double squared = 0.0;
  for (Eigen::Index at = 3 * part; at < d.size(); at += 6) {
    squared += d.template segment<3>(at).squaredNorm();
  }
  return std::sqrt(squared);
}

}  // namespace internal

/// Distance between the means of two densities in the named metric. On a group without poses
/// (SO(3), R^n) rotation and translation are the tangent norm.
template <LieGroup G>
double distance(const ConcentratedGaussian<G>& a, const ConcentratedGaussian<G>& b,
                DistanceMetric metric) {
  const typename G::Tangent d = (b.mean() * a.mean().inverse()).log();
  switch (metric) {
    case DistanceMetric::tangent_norm:
      return d.norm();
    case DistanceMetric::rotation:
      return internal::part_norm<G>(d, 0);
    case DistanceMetric::translation:
      return internal::part_norm<G>(d, 1);
    case DistanceMetric::mahalanobis: {
      const Eigen::LLT<typename G::TangentMatrix> sum(a.covariance() + b.covariance());
      return sum.matrixL().solve(d).norm();
    }
  }
  throw InvalidInput("distance: unknown metric");
}

/// Chooses pairs while a list of components shrinks. Costs of pairs that a merge leaves alone are
/// kept.
template <LieGroup G>
class PairSelector {
 public:
  using Components = std::vector<Component<ConcentratedGaussian<G>>>;

  PairSelector(const Components& components, PairRule rule, DistanceMetric metric)
      : rule_(rule), metric_(metric) {
    if (rule_ == PairRule::largest_with_smallest) return;
    costs_.resize(components.size());
    for (std::size_t row = 0; row < components.size(); ++row) {
      costs_[row].resize(row);
      for (std::size_t column = 0; column < row; ++column) {
        costs_[row][column] = cost(components[row], components[column]);
      }
    }
  }

  /// The next pair (a, b), a < b. Ties go to the pair found first in order of a, then b; for
  /// weights, to the first largest and the last smallest, so that equal weights never pair a
  /// component with itself.
  std::pair<std::size_t, std::size_t> next(const Components& components) const {
    if (rule_ == PairRule::largest_with_smallest) return extreme_weights(components);
    double best = std::numeric_limits<double>::infinity();
    std::pair<std::size_t, std::size_t> pair{0, 1};
    for (std::size_t a = 0; a < components.size(); ++a) {
      for (std::size_t b = a + 1; b < components.size(); ++b) {
        if (costs_[b][a] < best) {
          best = costs_[b][a];
          pair = {a, b};
        }
      }
    }
    return pair;
  }

  /// Tells that component a now holds the merge of a and b, and that b was erased.
  void merged(const Components& components, std::size_t a, std::size_t b) {
    if (rule_ == PairRule::largest_with_smallest) return;
    costs_.erase(costs_.begin() + static_cast<std::ptrdiff_t>(b));
    for (std::size_t row = b; row < costs_.size(); ++row) {
      costs_[row].erase(costs_[row].begin() + static_cast<std::ptrdiff_t>(b));
    }
    for (std::size_t other = 0; other < components.size(); ++other) {
      if (other == a) continue;
      const auto [column, row] = std::minmax(a, other);
      costs_[row][column] = cost(components[row], components[column]);
    }
  }

 private:
  static std::pair<std::size_t, std::size_t> extreme_weights(const Components& components) {
    std::size_t largest = 0;
    std::size_t smallest = 0;
    for (std::size_t i = 1; i < components.size(); ++i) {
      if (components[i].log_weight > components[largest].log_weight) largest = i;
      if (components[i].log_weight <= components[smallest].log_weight) smallest = i;
    }
    return std::minmax(largest, smallest);
  }

  double cost(const Component<ConcentratedGaussian<G>>& a,
              const Component<ConcentratedGaussian<G>>& b) const {
    switch (rule_) {
      case PairRule::most_distant:
        return -distance(a.density, b.density, metric_);
      case PairRule::runnalls:
        return runnalls_bound(a, b);
      case PairRule::symmetric_kl:
        return gaussian_symmetric_kl(a.density, b.density);
      case PairRule::largest_with_smallest:
        break;
    }
    throw InvalidInput("reduce: unknown pair rule");
  }

  PairRule rule_;
  DistanceMetric metric_;
  std::vector<std::vector<double>> costs_;
};

}  // namespace posemix
