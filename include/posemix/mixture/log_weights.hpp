// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

/// Sums and orders of weights that are kept as logarithms.
namespace posemix {

/// log(exp(a_0) + exp(a_1) + ...) without overflow or underflow; -inf for no terms or when all are
/// -inf.
double log_sum_exp(std::span<const double> terms);

/// @throws InvalidInput when a log-weight is NaN or +inf
void check_log_weights(std::span<const double> log_weights);

/// The log of the sum of the weights.
/// @throws InvalidInput when a log-weight is NaN or +inf, or all weights are zero
double checked_log_total(std::span<const double> log_weights);

/// The indices below `count` in order of falling `weight(i)`; equal weights keep their order.
template <class Weight>
std::vector<std::size_t> heaviest_first(std::size_t count, const Weight& weight) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return weight(a) > weight(b); });
  return order;
}

}  // namespace posemix
