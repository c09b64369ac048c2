// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>

#include "posemix/base/random.hpp"

namespace posemix {

/// The first index i < count at which the sum weight(0) + ... + weight(i) exceeds `target`, or
/// `otherwise` if rounding leaves no such index. With a target drawn uniformly between zero and the
/// sum of all weights, the index is drawn with probability proportional to its weight.
template <class Weight>
std::size_t index_at_sum(double target, std::size_t count, const Weight& weight,
                         std::size_t otherwise) {
  for (std::size_t i = 0; i < count; ++i) {
    target -= weight(i);
    if (target < 0.0) return i;
  }
  return otherwise;
}

/// An index drawn by weights that sum to `total`; where rounding leaves none, the last one of a
/// positive weight.
inline std::size_t draw_index(std::span<const double> weights, double total, RandomStream& stream) {
  std::size_t last = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > 0.0) last = i;
  }
  return index_at_sum(
      stream.uniform() * total, weights.size(), [&](std::size_t i) { return weights[i]; }, last);
}

}  // namespace posemix
