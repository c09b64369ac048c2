// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

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

}  // namespace posemix
