// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "posemix/base/range.hpp"
#include "posemix/mixture/log_weights.hpp"
#include "posemix/reduction/loss.hpp"
#include "posemix/reduction/merge.hpp"
#include "posemix/reduction/pair.hpp"

namespace posemix {

/// Settings of `reduce`.
struct ReductionSettings {
  static constexpr NumberRange kPruneBelow{.lowest = 0, .highest = 1, .without_highest = true};
  double prune_below = 5e-6;  ///< components with a smaller weight are dropped first
  /// This many of the lightest components are dropped after pruning; the heaviest always stays.
  std::size_t drop_smallest = 0;
  /// Only this many of the heaviest components are kept after pruning, without merging; 0: all.
  std::size_t keep_heaviest = 0;
  std::size_t max_components = 12;  ///< pairs are merged until no more than this many are left
  /// Pairs are merged only from this many components on; 0: from max_components + 1 on.
  std::size_t merge_from = 0;
  PairRule pair = PairRule::largest_with_smallest;
  DistanceMetric distance = DistanceMetric::tangent_norm;  ///< for PairRule::most_distant
  MergeSettings merge{};
  bool bound_loss = false;  ///< whether the report has bounds on the loss
};

/// One merge; the weights are fractions of the whole mixture.
struct MergeRecord {
  double weight_a;
  double weight_b;
  double distance;  ///< norm of Log(X_b X_a^-1) before the merge
};

/// The steps and the loss of one reduction.
struct ReductionReport {
  std::size_t components_before = 0;
  std::size_t components_pruned = 0;
  std::size_t components_after = 0;
  double weight_pruned = 0.0;
  double weight_moved = 0.0;  ///< sum over the merges of the smaller of the two weights
  std::vector<MergeRecord> merges;
  /// For every component before, the index of the component after that it is a part of, or
  /// kDropped.
  std::vector<std::size_t> destination;
  std::optional<BoundedLoss> bounded_loss;  ///< with ReductionSettings::bound_loss
  bool converged = true;
};

/// Result of `reduce`.
template <class D>
struct Reduction {
  Mixture<D> mixture;
  ReductionReport report;
};

namespace internal {

/// The indices of the `count` heaviest components in rising order; of equal weights the earlier.
template <class D>
std::vector<std::size_t> heaviest_of(std::span<const Component<D>> components, std::size_t count) {
  std::vector<std::size_t> order =
      heaviest_first(components.size(), [&](std::size_t i) { return components[i].log_weight; });
  order.resize(std::min(count, order.size()));
  std::sort(order.begin(), order.end());
  return order;
}

/// A mixture of the components at the given indices, which are in rising order.
template <class D>
Mixture<D> selected(std::vector<Component<D>> components, std::span<const std::size_t> indices) {
  std::vector<Component<D>> kept;
  kept.reserve(indices.size());
  for (const std::size_t i : indices) kept.push_back(std::move(components[i]));
  return Mixture<D>(std::move(kept));
}

/// Drops components of little weight: first those below prune_below, then the lightest.
template <class D>
Mixture<D> without_light(Mixture<D> mixture, const ReductionSettings& settings,
                         ReductionReport& report) {
  // `left` has the index before of every component that is left.
  std::vector<std::size_t> left = mixture.indices_not_below(settings.prune_below);
  report.weight_pruned = mixture.prune(settings.prune_below);
  std::size_t count = mixture.size() - std::min(settings.drop_smallest, mixture.size() - 1);
  if (settings.keep_heaviest > 0) count = std::min(count, settings.keep_heaviest);
  if (count < mixture.size()) {
    const std::vector<std::size_t> kept =
        heaviest_of<D>(std::span<const Component<D>>(mixture.components()), count);
    double dropped = 0.0;
    for (std::size_t i = 0; i < mixture.size(); ++i) {
      if (!std::binary_search(kept.begin(), kept.end(), i)) dropped += mixture.weight(i);
    }
    std::vector<std::size_t> left_of_these;
    left_of_these.reserve(kept.size());
    for (const std::size_t i : kept) left_of_these.push_back(left[i]);
    left = std::move(left_of_these);
    report.weight_pruned += (1.0 - report.weight_pruned) * dropped;
    mixture = selected<D>(std::move(mixture).release(), kept);
  }
  report.components_pruned = report.components_before - mixture.size();
  report.destination.assign(report.components_before, kDropped);
  for (std::size_t i = 0; i < left.size(); ++i) report.destination[left[i]] = i;
  return mixture;
}

/// Takes in a density that became a part of another. The memory of a stack's is for the next ones.
template <class D>
void reuse(D&& /*density*/) {}
void reuse(ConcentratedGaussian<PoseStackd>&& density);

/// Updates the destinations after component b became a part of component a < b.
inline void redirect(std::vector<std::size_t>& destination, std::size_t a, std::size_t b) {
  for (std::size_t& to : destination) {
    if (to == b) {
      to = a;
    } else if (to > b && to != kDropped) {
      --to;
    }
  }
}

/// Merges pairs until max_components are left.
template <class D>
void merge_pairs(std::vector<Component<D>>& components, const ReductionSettings& settings,
                 ReductionReport& report) {
  PairSelector<D> selector(components, settings.pair, settings.distance);
  while (components.size() > settings.max_components) {
    const auto [a, b] = selector.next(components);
    const Component<D>* const pair[] = {&components[a], &components[b]};
    const double w_a = std::exp(pair[0]->log_weight);
    const double w_b = std::exp(pair[1]->log_weight);
    report.merges.push_back(
        {w_a, w_b, distance(pair[0]->density, pair[1]->density, DistanceMetric::tangent_norm)});
    report.weight_moved += std::min(w_a, w_b);
    MergeResult<D> merged = merge(std::span<const Component<D>* const>(pair), settings.merge);
    report.converged = report.converged && merged.converged;
    reuse(std::exchange(components[a], std::move(merged.component)).density);
    reuse(std::move(components[b].density));
    components.erase(components.begin() + static_cast<std::ptrdiff_t>(b));
    redirect(report.destination, a, b);
    selector.merged(components, a, b);
  }
}

/// `reduce` without its last check: for a filter that has handed on what it would have to keep.
template <class D>
Reduction<D> reduced(Mixture<D> mixture, const ReductionSettings& settings) {
  require(settings.max_components > 0, "reduce: max_components is 0, expected at least 1");
  ReductionSettings::kPruneBelow.check(settings.prune_below, "reduce: prune_below");
  std::vector<Component<D>> before;
  if (settings.bound_loss) before = mixture.components();
  ReductionReport report;
  report.components_before = mixture.size();
  mixture = without_light(std::move(mixture), settings, report);

  std::vector<Component<D>> components = std::move(mixture).release();
  const std::size_t start =
      settings.merge_from == 0 ? settings.max_components + 1 : settings.merge_from;
  if (components.size() >= start) merge_pairs(components, settings, report);
  report.components_after = components.size();
  Reduction<D> result{Mixture<D>(std::move(components)), std::move(report)};
  if (settings.bound_loss) {
    result.report.bounded_loss = bounded_loss<D>(std::span<const Component<D>>(before),
                                                 result.mixture, result.report.destination);
  }
  return result;
}

}  // namespace internal

/// Reduces the number of components: prunes, drops the lightest, keeps the heaviest, then merges
/// pair after pair. The total weight is preserved (dropped weight is spread over the rest in
/// proportion). For concentrated Gaussians on any group, and for projected Gaussians.
/// @throws InvalidInput when max_components is zero or prune_below is not in [0, 1), and where the
/// covariance of a merged component overflows
template <class D>
Reduction<D> reduce(Mixture<D> mixture, const ReductionSettings& settings = {}) {
  Reduction<D> result = internal::reduced(std::move(mixture), settings);
  for (const Component<D>& component : result.mixture.components())
    internal::require_no_overflow(component.density, "reduction");
  return result;
}

extern template Reduction<ConcentratedGaussian<SO3d>> reduce(Mixture<ConcentratedGaussian<SO3d>>,
                                                             const ReductionSettings&);
extern template Reduction<ConcentratedGaussian<SE3d>> reduce(Mixture<ConcentratedGaussian<SE3d>>,
                                                             const ReductionSettings&);
extern template Reduction<ConcentratedGaussian<PoseStackd>> reduce(
    Mixture<ConcentratedGaussian<PoseStackd>>, const ReductionSettings&);
extern template Reduction<ProjectedGaussian<SO3d>> reduce(Mixture<ProjectedGaussian<SO3d>>,
                                                          const ReductionSettings&);
extern template Reduction<ProjectedGaussian<SE3d>> reduce(Mixture<ProjectedGaussian<SE3d>>,
                                                          const ReductionSettings&);

}  // namespace posemix
