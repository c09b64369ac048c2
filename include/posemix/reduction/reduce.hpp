// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "posemix/reduction/merge.hpp"
#include "posemix/reduction/pair.hpp"

namespace posemix {

/// Settings of `reduce`.
struct ReductionSettings {
  double prune_below = 5e-6;        ///< components with a smaller weight are dropped first
  std::size_t keep_heaviest = 0;    ///< after pruning only so many of the heaviest components are
                                    ///< kept, without merging; 0: all
  std::size_t max_components = 12;  ///< merging goes on until no more than this many are left
  std::size_t merge_from =
      0;  ///< merging starts at this many; 0: as soon as there are more than max_components
  PairRule pair = PairRule::largest_with_smallest;
  DistanceMetric distance = DistanceMetric::tangent_norm;  ///< for PairRule::most_distant
  MergeSettings merge{};
};

/// One merge, weights as fractions of the whole mixture.
struct MergeRecord {
  double weight_a;
  double weight_b;
  double distance;  ///< norm of Log(X_b X_a^-1) before the merge
};

/// What `reduce` did.
struct ReductionReport {
  std::size_t components_before = 0;
  std::size_t components_pruned = 0;
  std::size_t components_after = 0;
  double weight_pruned = 0.0;
  double weight_moved = 0.0;  ///< sum over the merges of the smaller of the two weights
  std::vector<MergeRecord> merges;
  bool converged = true;
};

/// Result of `reduce`.
template <class D>
struct Reduction {
  Mixture<D> mixture;
  ReductionReport report;
};

namespace internal {

/// The `count` heaviest components in their order (of equals the earlier) and the weight dropped.
template <class D>
std::pair<Mixture<D>, double> heaviest_of(Mixture<D> mixture, std::size_t count) {
  std::vector<Component<D>> components = std::move(mixture).release();
  std::vector<std::size_t> order(components.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return components[a].log_weight > components[b].log_weight;
  });
  double dropped = 0.0;
  for (std::size_t i = count; i < order.size(); ++i) {
    dropped += std::exp(components[order[i]].log_weight);
  }
  order.resize(count);
  std::sort(order.begin(), order.end());
  std::vector<Component<D>> kept;
  kept.reserve(count);
  for (const std::size_t i : order) kept.push_back(std::move(components[i]));
  return {Mixture<D>(std::move(kept)), dropped};
}

}  // namespace internal

/// A mixture with fewer components: prune, keep the heaviest, then merge pair after pair. Total
/// weight is preserved (pruned weight is spread over the rest in proportion).
/// @throws InvalidInput when max_components is zero or prune_below is not in [0, 1)
template <LieGroup G>
Reduction<ConcentratedGaussian<G>> reduce(Mixture<ConcentratedGaussian<G>> mixture,
                                          const ReductionSettings& settings = {}) {
  using Density = ConcentratedGaussian<G>;
  require(settings.max_components > 0, "reduce: max_components is 0, expected at least 1");
  require(settings.prune_below >= 0.0 && settings.prune_below < 1.0,
          "reduce: prune_below must lie in [0, 1)");
  ReductionReport report;
  report.components_before = mixture.size();
  report.weight_pruned = mixture.prune(settings.prune_below);
  if (settings.keep_heaviest > 0 && mixture.size() > settings.keep_heaviest) {
    const double left = 1.0 - report.weight_pruned;
    auto [kept, dropped] = internal::heaviest_of(std::move(mixture), settings.keep_heaviest);
    mixture = std::move(kept);
    report.weight_pruned += left * dropped;
  }
  report.components_pruned = report.components_before - mixture.size();

  std::vector<Component<Density>> components = std::move(mixture).release();
  const std::size_t start =
      settings.merge_from == 0 ? settings.max_components + 1 : settings.merge_from;
  if (components.size() >= start) {
    PairSelector<G> selector(components, settings.pair, settings.distance);
    while (components.size() > settings.max_components) {
      const auto [a, b] = selector.next(components);
      const Component<Density>* const pair[] = {&components[a], &components[b]};
      const double w_a = std::exp(pair[0]->log_weight);
      const double w_b = std::exp(pair[1]->log_weight);
      report.merges.push_back(
          {w_a, w_b, distance(pair[0]->density, pair[1]->density, DistanceMetric::tangent_norm)});
      report.weight_moved += std::min(w_a, w_b);
      MergeResult<Density> merged =
          merge<G>(std::span<const Component<Density>* const>(pair), settings.merge);
      report.converged = report.converged && merged.converged;
      components[a] = std::move(merged.component);
      components.erase(components.begin() + static_cast<std::ptrdiff_t>(b));
      selector.merged(components, a, b);
    }
  }
  report.components_after = components.size();
  return {Mixture<Density>(std::move(components)), std::move(report)};
}

extern template Reduction<ConcentratedGaussian<SO3d>> reduce(Mixture<ConcentratedGaussian<SO3d>>,
                                                             const ReductionSettings&);
extern template Reduction<ConcentratedGaussian<SE3d>> reduce(Mixture<ConcentratedGaussian<SE3d>>,
                                                             const ReductionSettings&);
extern template Reduction<ConcentratedGaussian<PoseStackd>> reduce(
    Mixture<ConcentratedGaussian<PoseStackd>>, const ReductionSettings&);

}  // namespace posemix
