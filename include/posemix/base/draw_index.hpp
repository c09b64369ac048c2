// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

namespace posemix {

/// The first index i < count at which the sum weight(0) + ... + weight(i) exceeds `target`; for a
/// target drawn uniformly below the sum of all weights, an index drawn by them. `otherwise` is the
/// result where rounding leaves no such index.
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
