// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <utility>
#include <vector>

#include "density.hpp"
#include "posemix/mixture/operations.hpp"
#include "posemix/mixture/projected_operations.hpp"

namespace posemix::python {

/// Components from equally many log-weights and densities.
template <class D>
std::vector<Component<D>> components_of(const std::vector<double>& log_weights,
                                        const std::vector<D>& densities) {
  if (log_weights.size() != densities.size()) {
    throw InvalidInput(
        fmt::format("{} weights for {} components", log_weights.size(), densities.size()));
  }
  std::vector<Component<D>> components;
  components.reserve(densities.size());
  for (std::size_t i = 0; i < densities.size(); ++i)
    components.push_back({log_weights[i], densities[i]});
  return components;
}

}  // namespace posemix::python
