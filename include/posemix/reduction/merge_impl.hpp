// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <vector>

#include "posemix/lie/mean.hpp"
#include "posemix/reduction/merge.hpp"

namespace posemix {
namespace internal {

/// Index of the largest weight; the first of equals.
template <class D>
std::size_t heaviest(std::span<const Component<D>> components) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < components.size(); ++i) {
    if (components[i].log_weight > components[best].log_weight) best = i;
  }
  return best;
}

/// The components that carry weight (all of them, equally, when none does) and the log of their
/// summed weight.
template <class D>
struct Carrying {
  std::vector<Component<D>> components;
  double log_total;

  explicit Carrying(std::span<const Component<D>> all) {
    std::vector<double> log_weights;
    for (const auto& component : all) log_weights.push_back(component.log_weight);
    log_total = log_sum_exp(log_weights);
    for (const auto& component : all) {
      if (std::isinf(log_total)) {
        components.push_back({0.0, component.density});
      } else if (!std::isinf(component.log_weight)) {
        components.push_back(component);
      }
    }
  }
};

/// The midway point of components that all carry weight.
template <LieGroup G>
MeanResult<G> carrying_midway_point(std::span<const Component<ConcentratedGaussian<G>>> components,
                                    const MergeSettings& settings) {
  if (components.size() == 2) {
    const double log_ratio = components[0].log_weight - components[1].log_weight;
    const double w_2 = 1.0 / (1.0 + std::exp(log_ratio));
    const G& x_1 = components[0].density.mean();
    return {interpolate(x_1, components[1].density.mean(), w_2), true, 1, 0.0};  // eq. 12
  }
  const double largest = components[heaviest(components)].log_weight;
  std::vector<G> means;
  std::vector<double> weights;
  for (const auto& component : components) {
    means.push_back(component.density.mean());
    weights.push_back(std::exp(component.log_weight - largest));
  }
  return weighted_mean<G>(means, weights,
                          MeanSettings{settings.max_iterations, settings.tolerance});
}

}  // namespace internal

template <LieGroup G>
MeanResult<G> midway_point(std::span<const Component<ConcentratedGaussian<G>>> components,
                           const MergeSettings& settings) {
  require(!components.empty(), "midway_point: there is no component");
  const internal::Carrying<ConcentratedGaussian<G>> carrying(components);
  return internal::carrying_midway_point<G>(carrying.components, settings);
}

template <LieGroup G>
MergeResult<ConcentratedGaussian<G>> merge(
    std::span<const Component<ConcentratedGaussian<G>>> components, const MergeSettings& settings) {
  using Density = ConcentratedGaussian<G>;
  require(!components.empty(), "merge: there is no component");
  if (components.size() == 1) return {components.front(), true};

  const internal::Carrying<Density> carrying(components);
  const std::span<const Component<Density>> parts(carrying.components);
  if (parts.size() == 1) return {{carrying.log_total, parts.front().density}, true};

  switch (settings.rule) {
    case MergeRule::midway: {
      const MeanResult<G> midway = internal::carrying_midway_point(parts, settings);
      TangentGaussian<G> merged = tangent_moments(parts, midway.mean, settings.jacobian);  // eq. 18
      return {{carrying.log_total, Density::trusted(midway.mean, std::move(merged.covariance))},
              midway.converged};
    }
    case MergeRule::tangent_of_larger: {
      const G& anchor = parts[internal::heaviest(parts)].density.mean();
      const TangentGaussian<G> merged = tangent_moments(parts, anchor, settings.jacobian);
      return {{carrying.log_total, back_project(merged)}, true};
    }
    case MergeRule::moment_matched: {
      Moments<Density> matched = moments<G>(parts, {settings.max_iterations, settings.tolerance});
      return {{carrying.log_total, std::move(matched.density)}, matched.converged};
    }
  }
  throw InvalidInput("merge: unknown rule");
}

}  // namespace posemix
