// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "posemix/base/draw_index.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"
#include "posemix/base/range.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix {

/// One weighted peak of a mixture.
template <class D>
struct Component {
  double log_weight;
  D density;
};

namespace internal {

template <class D>
std::vector<double> log_weights_of(std::span<const Component<D>> components) {
  std::vector<double> log_weights(components.size());
  std::transform(components.begin(), components.end(), log_weights.begin(),
                 [](const auto& component) { return component.log_weight; });
  return log_weights;
}

/// @throws InvalidInput as checked_log_total
template <class D>
LogScale checked_log_scale(std::span<const Component<D>> components) {
  return checked_log_scale(std::span<const double>(log_weights_of(components)));
}

}  // namespace internal

/// The log of the sum of the components' weights.
/// @throws InvalidInput when a log-weight is NaN or +inf, or all weights are zero
template <class D>
double checked_log_total(std::span<const Component<D>> components) {
  return checked_log_total(std::span<const double>(internal::log_weights_of(components)));
}

/// A mixture sum_i w_i D_i of densities of one kind over one group (midway-merge paper, eq. 6).
///
/// Invariants, tested as a list:
///  - there is at least one component, and all have the same number of degrees of freedom;
///  - the weights are kept as logarithms and sum to one; a weight of zero (log -inf) is allowed;
///  - exp(log_density(X)) = sum_i w_i exp(log_density_i(X)).
template <class D>
class Mixture {
 public:
  using Density = D;
  using Group = typename D::Group;

  /// Normalises the weights.
  /// @throws InvalidInput when there is no component, a log-weight is NaN or +inf, all weights are
  /// zero, or sizes differ
  explicit Mixture(std::vector<Component<D>> components) : Mixture(std::move(components), 0.0) {}

  /// A mixture of components that came from a mixture: if the weights sum to one within 1e-12, the
  /// log-weights are kept bit by bit, otherwise they are normalised.
  /// @throws InvalidInput as the constructor
  static Mixture from_stored(std::vector<Component<D>> components) {
    return Mixture(std::move(components), 1e-12);
  }

  /// A mixture from plain weights, which are normalised.
  /// @throws InvalidInput when sizes differ, a weight is negative or not finite, or all are zero
  static Mixture from_weights(std::span<const double> weights, std::vector<D> densities) {
    if (weights.size() != densities.size()) {
      throw InvalidInput(
          fmt::format("{} weights for {} components", weights.size(), densities.size()));
    }
    std::vector<Component<D>> components;
    components.reserve(weights.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (!(weights[i] >= 0.0) || !std::isfinite(weights[i])) {
        throw InvalidInput(
            fmt::format("weight {} is {}, expected a finite number >= 0", i, weights[i]));
      }
      components.push_back({std::log(weights[i]), std::move(densities[i])});
    }
    return Mixture(std::move(components));
  }

  std::size_t size() const { return components_.size(); }
  Eigen::Index dof() const { return components_.front().density.dof(); }
  const std::vector<Component<D>>& components() const { return components_; }
  const Component<D>& operator[](std::size_t i) const {
    internal::check_index(i, size(), "component");
    return components_[i];
  }
  double weight(std::size_t i) const { return std::exp((*this)[i].log_weight); }

  /// Index of the largest weight; the first of equals.
  std::size_t heaviest() const {
    const auto heavier = [](const auto& a, const auto& b) { return a.log_weight < b.log_weight; };
    const auto it = std::max_element(components_.begin(), components_.end(), heavier);
    return static_cast<std::size_t>(it - components_.begin());
  }

  /// Log density at one element. For many elements, build an Evaluator once.
  template <class Element>
  double log_density(const Element& element) const {
    return Evaluator(*this).log_density(element);
  }

  /// One draw: a component by its weight, then a draw from it.
  auto sample(RandomStream& stream) const {
    return components_[draw_index(stream)].density.sample(stream);
  }

  /// The index of a component, drawn by the weights.
  std::size_t draw_index(RandomStream& stream) const {
    return index_at_sum(
        stream.uniform(), size(), [this](std::size_t i) { return weight(i); }, heaviest());
  }

  /// The indices, in rising order, of the components that prune(threshold) keeps.
  /// @throws InvalidInput when the threshold is not a number
  std::vector<std::size_t> indices_not_below(double threshold) const {
    if (std::isnan(threshold)) throw InvalidInput("threshold is nan, expected a number");
    const std::size_t kept = heaviest();
    std::vector<std::size_t> indices;
    indices.reserve(size());
    for (std::size_t i = 0; i < size(); ++i) {
      if (i == kept || weight(i) >= threshold) indices.push_back(i);
    }
    return indices;
  }

  /// Drops every component whose weight is below `threshold` (the heaviest always stays),
  /// normalises, and returns the weight dropped.
  /// @throws InvalidInput when the threshold is not a number
  double prune(double threshold) {
    const std::vector<std::size_t> kept = indices_not_below(threshold);
    double dropped = 0.0;
    std::vector<Component<D>> remaining;
    remaining.reserve(kept.size());
    for (std::size_t i = 0; i < size(); ++i) {
      if (remaining.size() < kept.size() && kept[remaining.size()] == i) {
        remaining.push_back(std::move(components_[i]));
      } else {
        dropped += weight(i);
      }
    }
    components_ = std::move(remaining);
    normalize();
    return dropped;
  }

  /// Moves the components out; the mixture must not be used afterwards.
  std::vector<Component<D>> release() && { return std::move(components_); }

  /// Evaluates the log density at many elements; every component is factorised once.
  class Evaluator {
   public:
    explicit Evaluator(const Mixture& mixture) {
      for (const auto& component : mixture.components()) {
        if (std::isinf(component.log_weight)) continue;
        log_weights_.push_back(component.log_weight);
        densities_.emplace_back(component.density);
      }
    }

    template <class Element>
    double log_density(const Element& element) const {
      std::vector<double> terms(densities_.size());
      for (std::size_t i = 0; i < terms.size(); ++i) {
        terms[i] = log_weights_[i] + densities_[i].log_density(element);
      }
      return log_sum_exp(terms);
    }

   private:
    std::vector<double> log_weights_;
    std::vector<typename D::Evaluator> densities_;
  };

 private:
  Mixture(std::vector<Component<D>> components, double tolerance)
      : components_(std::move(components)) {
    require(!components_.empty(), "a mixture needs at least one component");
    for (const auto& component : components_) {
      if (component.density.dof() != components_.front().density.dof()) {
        throw InvalidInput(fmt::format("mixture components of {} and {} degrees of freedom",
                                       components_.front().density.dof(), component.density.dof()));
      }
    }
    normalize(tolerance);
  }

  /// Normalises the weights unless the log of their sum is within `tolerance` of zero.
  void normalize(double tolerance = 0.0) {
    const internal::LogScale scale =
        internal::checked_log_scale(std::span<const Component<D>>(components_));
    if (std::abs(scale.first) <= tolerance) return;
    for (auto& component : components_) component.log_weight = scale(component.log_weight);
  }

  std::vector<Component<D>> components_;
};

}  // namespace posemix
