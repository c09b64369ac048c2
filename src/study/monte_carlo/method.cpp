// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/slam/method.hpp"
#include "trial.hpp"

namespace posemix {
namespace {

/// A filter of the study: a method of the paper, for one object, and what is changed.
struct KnownMethod {
  const char* name;
  const char* preset;
  bool single_gaussian = false;
  void (*change)(GaussianSumSettings&) = nullptr;
};

constexpr std::array kMethods{
    KnownMethod{"midway", "midway"},
    KnownMethod{"tangent_of_larger", "tangent_of_larger"},
    KnownMethod{"moment_matched", "midway", false,
                [](GaussianSumSettings& filter) {
                  filter.reduction.merge.rule = MergeRule::moment_matched;
                }},
    KnownMethod{"runnalls_pairs", "midway", false,
                [](GaussianSumSettings& filter) { filter.reduction.pair = PairRule::runnalls; }},
    KnownMethod{"largest_with_smallest", "midway", false,
                [](GaussianSumSettings& filter) {
                  filter.reduction.pair = PairRule::largest_with_smallest;
                }},
    KnownMethod{"no_merge_64", "midway", false,
                [](GaussianSumSettings& filter) {
                  filter.reduction.max_components = 64;
                  filter.reduction.keep_heaviest = 64;
                  filter.summary = Summary::whole_mixture;
                }},
    KnownMethod{"riekf", "midway", true},
    KnownMethod{"iterated", "midway_iterated"},
    KnownMethod{"iterated_tangent_of_larger", "tangent_of_larger", false,
                [](GaussianSumSettings& filter) { filter.update = UpdateRule::iterated; }},
    KnownMethod{"iterated_riekf", "midway_iterated", true}};

}  // namespace

const std::vector<std::string>& monte_carlo_methods() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    all.reserve(kMethods.size());
    for (const KnownMethod& known : kMethods) all.emplace_back(known.name);
    return all;
  }();
  return names;
}

MonteCarloMethod monte_carlo_method(const std::string& name,
                                    const MonteCarloStudySettings& settings) {
  const auto known = std::find_if(kMethods.begin(), kMethods.end(),
                                  [&](const KnownMethod& each) { return each.name == name; });
  if (known == kMethods.end()) {
    throw InvalidInput(fmt::format("there is no method '{}'; expected one of {}", name,
                                   fmt::join(monte_carlo_methods(), ", ")));
  }
  // The paper's filter for several objects, as it is for one: noise by object, other pairs, N_h.
  MonteCarloMethod method{std::get<GaussianSumSettings>(find_slam_method(known->preset).tracker),
                          known->single_gaussian};
  GaussianSumSettings& filter = method.filter;
  filter.noise_use = NoiseUse::per_object;
  filter.reduction.prune_below = settings.prune_below;
  filter.reduction.max_components = settings.max_components;
  filter.reduction.pair = PairRule::most_distant;
  if (known->change != nullptr) known->change(filter);
  return method;
}

}  // namespace posemix
