// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "posemix/base/draw_index.hpp"
#include "posemix/mixture/em.hpp"

/// The starts of EM.
namespace posemix::internal {

/// The largest number of samples, evenly spaced among all, that are used to find a start.
inline constexpr std::size_t kStartSamples = 4096;

template <EmDensity D>
class EmStart {
 public:
  using Element = typename D::Group;

  EmStart(std::span<const Element> samples, std::span<const double> weights,
          const EmSettings& settings)
      : settings_(settings) {
    std::vector<std::size_t> used;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (weights[i] > 0.0) used.push_back(i);
    }
    const std::size_t count = std::min(used.size(), kStartSamples);
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t i = used[j * used.size() / count];
      elements_.push_back(samples[i]);
      weights_.push_back(weights[i]);
    }
    whole_.push_back(EmModel<D>::start(elements_, weights_, settings_, nullptr));
  }

  /// The start of the given attempt, counted from zero.
  Mixture<D> draw(int attempt, RandomStream& stream) const {
    if (settings_.components == 1) return Mixture<D>({{0.0, whole_.front()}});
    const bool concentric = settings_.fixed_means || attempt % 2 == 1;
    return concentric ? concentric_components(attempt > 1, stream) : clusters(stream);
  }

 private:
  /// Components with spreads from a quarter to one and a half times the spread of all samples. With
  /// `scattered`, the spread of every coordinate is multiplied by a random factor.
  Mixture<D> concentric_components(bool scattered, RandomStream& stream) const {
    constexpr double kNarrowest = 0.25;
    constexpr double kWidest = 1.5;
    std::vector<Component<D>> components;
    const std::size_t count = settings_.components;
    for (std::size_t k = 0; k < count; ++k) {
      const double part = static_cast<double>(k) / static_cast<double>(count - 1);
      Eigen::VectorXd factors = Eigen::VectorXd::Constant(
          whole_.front().dof(), kNarrowest * std::pow(kWidest / kNarrowest, part));
      if (scattered) {
        for (double& factor : factors) factor *= std::exp(0.7 * stream.normal());
      }
      components.push_back({0.0, EmModel<D>::stretched(whole_.front(), factors)});
    }
    return Mixture<D>(std::move(components));
  }

  /// k-means++ (Arthur and Vassilvitskii, k-means++: the advantages of careful seeding, 2007):
  /// every further centre is drawn with probability proportional to the squared distance to the
  /// nearest centre so far. Then every centre makes one component of the samples nearest to it.
  Mixture<D> clusters(RandomStream& stream) const {
    const std::size_t n = elements_.size();
    std::vector<double> distance(n, std::numeric_limits<double>::infinity());
    std::vector<double> chance = weights_;
    std::vector<std::size_t> nearest(n, 0);
    for (std::size_t k = 0; k < settings_.components; ++k) {
      double total = 0.0;
      for (const double c : chance) total += c;
      const Element& centre = elements_[draw_index(chance, total, stream)];
      for (std::size_t i = 0; i < n; ++i) {
        const double d = EmModel<D>::squared_distance(whole_.front(), elements_[i], centre);
        if (d < distance[i]) {
          distance[i] = d;
          nearest[i] = k;
        }
        chance[i] = weights_[i] * distance[i];
      }
    }
    return from_clusters(nearest);
  }

  Mixture<D> from_clusters(const std::vector<std::size_t>& nearest) const {
    std::vector<Component<D>> components;
    for (std::size_t k = 0; k < settings_.components; ++k) {
      std::vector<Element> members;
      std::vector<double> weights;
      double total = 0.0;
      for (std::size_t i = 0; i < nearest.size(); ++i) {
        if (nearest[i] != k) continue;
        members.push_back(elements_[i]);
        weights.push_back(weights_[i]);
        total += weights_[i];
      }
      if (members.empty()) {  // there are fewer different samples than components
        components.push_back({std::log(weights_.front()), whole_.front()});
      } else {
        components.push_back(
            {std::log(total), EmModel<D>::start(members, weights, settings_, &whole_.front())});
      }
    }
    return Mixture<D>(std::move(components));
  }

  EmSettings settings_;
  std::vector<Element> elements_;
  std::vector<double> weights_;
  std::vector<D> whole_;  ///< one density for all samples
};

}  // namespace posemix::internal
