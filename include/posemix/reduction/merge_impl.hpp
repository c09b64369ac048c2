// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "posemix/lie/mean.hpp"
#include "posemix/reduction/merge.hpp"

namespace posemix {
namespace internal {

/// The components of positive weight (or all, with equal weights, if no weight is positive), with
/// their normalised weights and the log of the sum of their weights.
template <class Density>
struct Carrying {
  using G = typename Density::Group;

  double log_total;
  std::vector<double> weights;
  std::vector<const Density*> densities;

  explicit Carrying(std::span<const Component<Density>* const> all) {
    std::vector<double> log_weights;
    log_weights.reserve(all.size());
    for (const auto* component : all) log_weights.push_back(component->log_weight);
    check_log_weights(log_weights);
    log_total = log_sum_exp(log_weights);
    const bool none = std::isinf(log_total);
    weights.reserve(all.size());
    densities.reserve(all.size());
    for (const auto* component : all) {
      if (!none && std::isinf(component->log_weight)) continue;
      weights.push_back(none ? 1.0 / static_cast<double>(all.size())
                             : std::exp(component->log_weight - log_total));
      densities.push_back(&component->density);
    }
  }

  std::size_t size() const { return densities.size(); }
  const G& mean(std::size_t i) const { return densities[i]->mean(); }

  /// Index of the largest weight; the first of equals.
  std::size_t heaviest() const {
    const auto largest = std::max_element(weights.begin(), weights.end());
    return static_cast<std::size_t>(largest - weights.begin());
  }

  /// The components with their positions relative to `anchor`.
  std::vector<SeenFrom<G>> seen_from(const G& anchor) const {
    const G inverse = anchor.inverse();
    std::vector<SeenFrom<G>> parts;
    parts.reserve(size());
    for (std::size_t i = 0; i < size(); ++i) {
      parts.push_back({weights[i], densities[i], (mean(i) * inverse).log()});
    }
    return parts;
  }
};

/// Ad(x) xi, the adjoint applied to a tangent vector.
template <LieGroup G>
typename G::Tangent adjoint_times(const G& x, const typename G::Tangent& xi) {
  if constexpr (requires { x.adjoint_times(xi); }) {
    return x.adjoint_times(xi);
  } else {
    return x.adjoint() * xi;
  }
}

/// The midway point of components of positive weight, and their positions relative to it.
template <LieGroup G>
struct Midway {
  MeanResult<G> point;
  std::vector<SeenFrom<G>> parts;
};

/// Eq. 12: with dx = Log(X_2 X_1^-1) the point is Exp(w_2 dx) X_1; relative to it X_1 is at -w_2 dx
/// and X_2 at w_1 dx. Computed from Log(X_1^-1 X_2) = Ad(X_1^-1) dx, which does not lose digits far
/// from the origin.
template <LieGroup G>
Midway<G> midway_of_two(const Carrying<ConcentratedGaussian<G>>& two) {
  const double w_1 = two.weights[0];
  const double w_2 = two.weights[1];
  const G& x_1 = two.mean(0);
  const typename G::Tangent body = (x_1.inverse() * two.mean(1)).log();
  const typename G::Tangent dx = adjoint_times(x_1, body);
  return {{x_1 * G::exp(w_2 * body), true, 1, 0.0},
          {{w_1, two.densities[0], -w_2 * dx}, {w_2, two.densities[1], w_1 * dx}}};
}

template <LieGroup G>
Midway<G> midway_of(const Carrying<ConcentratedGaussian<G>>& carrying,
                    const MergeSettings& settings) {
  if (carrying.size() == 2) return midway_of_two(carrying);
  std::vector<G> means;
  means.reserve(carrying.size());
  for (std::size_t i = 0; i < carrying.size(); ++i) means.push_back(carrying.mean(i));
  MeanResult<G> point = weighted_mean<G>(means, carrying.weights,
                                         MeanSettings{settings.max_iterations, settings.tolerance});
  return {point, carrying.seen_from(point.mean)};
}

/// The merge of two stacks by the rules midway or tangent_of_larger, where `first` has the tangent
/// space, with weights of sum one, with vector instructions; the templates here are the reference.
ConcentratedGaussian<PoseStackd> merged_pair(MergeRule rule, double w_1, double w_2,
                                             const ConcentratedGaussian<PoseStackd>& first,
                                             const ConcentratedGaussian<PoseStackd>& second);

/// Whether merged_pair() is for these components.
template <LieGroup G>
bool is_stack_pair(const Carrying<ConcentratedGaussian<G>>& carrying,
                   const MergeSettings& settings) {
  if constexpr (std::same_as<G, PoseStackd>) {
    return settings.rule != MergeRule::moment_matched &&
           settings.jacobian == TransportJacobian::exact && carrying.size() == 2 &&
           carrying.mean(0).size() == carrying.mean(1).size() && carrying.mean(0).size() > 0;
  }
  return false;
}

/// The merge on R^n, where all rules match the same moments.
template <class G>
ConcentratedGaussian<G> merged_vectors(const Carrying<ConcentratedGaussian<G>>& carrying) {
  using Vector = typename G::Tangent;
  using Matrix = typename G::TangentMatrix;
  for (const auto* density : carrying.densities) {
    if (density->dof() == carrying.mean(0).dof()) continue;
    throw InvalidInput(fmt::format("merge: components of {} and {} degrees of freedom",
                                   carrying.mean(0).dof(), density->dof()));
  }
  // About the first mean, and by weights whose sum is one but for one rounding: the logarithms of
  // small ones have lost digits.
  const double total = std::accumulate(carrying.weights.begin(), carrying.weights.end(), 0.0);
  const Vector& first = carrying.mean(0).value();
  Vector mean = Vector::Zero(first.size());
  for (std::size_t i = 1; i < carrying.size(); ++i)
    mean += carrying.weights[i] / total * (carrying.mean(i).value() - first);
  mean += first;
  Matrix covariance = Matrix::Zero(mean.size(), mean.size());
  for (std::size_t i = 0; i < carrying.size(); ++i) {
    const double weight = carrying.weights[i] / total;
    const Vector apart = carrying.mean(i).value() - mean;
    covariance.noalias() += weight * apart * apart.transpose();
    covariance += weight * carrying.densities[i]->covariance();
  }
  symmetrize(covariance);
  return ConcentratedGaussian<G>::trusted(G(mean), std::move(covariance));
}

/// The merge where it is found at once: of vectors, and of two stacks by vector instructions. The
/// rule is a known one.
template <class G>
std::optional<ConcentratedGaussian<G>> merged_at_once(
    const Carrying<ConcentratedGaussian<G>>& carrying, const MergeSettings& settings) {
  if constexpr (kIsVectorSpace<G>) return merged_vectors(carrying);
  if constexpr (std::same_as<G, PoseStackd>) {
    if (is_stack_pair(carrying, settings)) {
      const std::size_t first = settings.rule == MergeRule::midway ? 0 : carrying.heaviest();
      return merged_pair(settings.rule, carrying.weights[first], carrying.weights[1 - first],
                         *carrying.densities[first], *carrying.densities[1 - first]);
    }
  }
  return std::nullopt;
}

/// Pointers to components that lie next to each other in memory.
template <class D>
std::vector<const Component<D>*> pointers_to(std::span<const Component<D>> components) {
  std::vector<const Component<D>*> pointers;
  pointers.reserve(components.size());
  for (const auto& component : components) pointers.push_back(&component);
  return pointers;
}

}  // namespace internal

template <LieGroup G>
MeanResult<G> midway_point(std::span<const Component<ConcentratedGaussian<G>>> components,
                           const MergeSettings& settings) {
  require(!components.empty(), "midway_point: there is no component");
  const internal::Carrying<ConcentratedGaussian<G>> carrying(internal::pointers_to(components));
  return internal::midway_of(carrying, settings).point;
}

template <LieGroup G>
MergeResult<ConcentratedGaussian<G>> merge(
    std::span<const Component<ConcentratedGaussian<G>>* const> components,
    const MergeSettings& settings) {
  using Density = ConcentratedGaussian<G>;
  require(!components.empty(), "merge: there is no component");
  const internal::Carrying<Density> carrying(components);
  if (components.size() == 1) return {*components.front(), true};
  const double log_weight = carrying.log_total;
  if (carrying.size() == 1) return {{log_weight, *carrying.densities.front()}, true};
  require(!word_of(settings.rule).empty(), "merge: unknown rule");
  if (auto merged = internal::merged_at_once(carrying, settings))
    return {{log_weight, *std::move(merged)}, true};

  switch (settings.rule) {
    case MergeRule::midway: {
      const internal::Midway<G> midway = internal::midway_of(carrying, settings);
      TangentGaussian<G> merged = internal::moments_at<G>(midway.point.mean, midway.parts,
                                                          settings.jacobian);  // eq. 18
      return {
          {log_weight, Density::trusted(std::move(merged.anchor), std::move(merged.covariance))},
          midway.point.converged};
    }
    case MergeRule::tangent_of_larger: {
      const G& anchor = carrying.mean(carrying.heaviest());
      return {{log_weight, back_project(internal::moments_at<G>(anchor, carrying.seen_from(anchor),
                                                                settings.jacobian))},
              true};
    }
    case MergeRule::moment_matched: {
      Moments<Density> matched = internal::moments_of<G>(
          carrying.weights, carrying.densities, {settings.max_iterations, settings.tolerance});
      return {{log_weight, std::move(matched.density)}, matched.converged};
    }
  }
  throw InvalidInput("merge: unknown rule");
}

template <LieGroup G>
MergeResult<ConcentratedGaussian<G>> merge(
    std::span<const Component<ConcentratedGaussian<G>>> components, const MergeSettings& settings) {
  return merge<G>(
      std::span<const Component<ConcentratedGaussian<G>>* const>(internal::pointers_to(components)),
      settings);
}

// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_MERGE(prefix, G)                                                                  \
  prefix template MeanResult<G> midway_point(std::span<const Component<ConcentratedGaussian<G>>>, \
                                             const MergeSettings&);                               \
  prefix template MergeResult<ConcentratedGaussian<G>> merge(                                     \
      std::span<const Component<ConcentratedGaussian<G>>* const>, const MergeSettings&);          \
  prefix template MergeResult<ConcentratedGaussian<G>> merge(                                     \
      std::span<const Component<ConcentratedGaussian<G>>>, const MergeSettings&)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_MERGE(extern, SO3d);
POSEMIX_MERGE(extern, SE3d);
POSEMIX_MERGE(extern, PoseStackd);
POSEMIX_MERGE(extern, Rnd<3>);

}  // namespace posemix
