// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/slam/method.hpp"
#include "trial.hpp"

namespace posemix {

const std::vector<std::string>& monte_carlo_methods() {
  static const std::vector<std::string> names{"midway",
                                              "tangent_of_larger",
                                              "moment_matched",
                                              "runnalls_pairs",
                                              "largest_with_smallest",
                                              "no_merge_64",
                                              "riekf",
                                              "iterated",
                                              "iterated_tangent_of_larger",
                                              "iterated_riekf"};
  return names;
}

MonteCarloMethod monte_carlo_method(const std::string& name,
                                    const MonteCarloStudySettings& settings) {
  const auto& names = monte_carlo_methods();
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw InvalidInput(
        fmt::format("there is no method '{}'; expected one of {}", name, fmt::join(names, ", ")));
  }
  // The paper's filter for several objects, as it is for one: noise by object, other pairs, N_h.
  MonteCarloMethod method{std::get<GaussianSumSettings>(find_slam_method("midway").tracker),
                          name == "riekf" || name == "iterated_riekf"};
  GaussianSumSettings& filter = method.filter;
  filter.noise_use = NoiseUse::per_object;
  filter.update = name.starts_with("iterated") ? UpdateRule::iterated : UpdateRule::linearized;
  filter.reduction.prune_below = settings.prune_below;
  filter.reduction.max_components = settings.max_components;
  filter.reduction.pair = PairRule::most_distant;
  if (name == "tangent_of_larger" || name == "iterated_tangent_of_larger") {
    filter.reduction.merge.rule = MergeRule::tangent_of_larger;
  } else if (name == "moment_matched") {
    filter.reduction.merge.rule = MergeRule::moment_matched;
  } else if (name == "runnalls_pairs") {
    filter.reduction.pair = PairRule::runnalls;
  } else if (name == "largest_with_smallest") {
    filter.reduction.pair = PairRule::largest_with_smallest;
  } else if (name == "no_merge_64") {
    filter.reduction.max_components = 64;
    filter.reduction.keep_heaviest = 64;
    filter.summary = Summary::whole_mixture;
  }
  return method;
}

}  // namespace posemix
