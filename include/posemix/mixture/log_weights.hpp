// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

/// Sums and orders of weights that are kept as logarithms.
namespace posemix {

/// log(exp(a_0) + exp(a_1) + ...) without overflow or underflow; -inf for no terms or when all are
/// -inf.
double log_sum_exp(std::span<const double> terms);
/// The same of `term(0)`, ..., `term(count - 1)`, each of which is asked for twice.
template <class Term>
double log_sum_exp(std::size_t count, const Term& term) {
  if (count == 0) return -std::numeric_limits<double>::infinity();
  double largest = term(0);
  for (std::size_t i = 1; i < count; ++i) largest = std::max(largest, term(i));
  if (std::isinf(largest)) return largest;
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += std::exp(term(i) - largest);
  return largest + std::log(sum);
}

/// @throws InvalidInput when a log-weight is NaN or +inf
void check_log_weights(std::span<const double> log_weights);

/// The log of the sum of the weights.
/// @throws InvalidInput when a log-weight is NaN or +inf, or all weights are zero
double checked_log_total(std::span<const double> log_weights);

namespace internal {

/// The log of a sum of weights, in two parts: of weights such as exp(-1e12) a single number has not
/// the digits for the quotients.
struct LogScale {
  double first;
  double second;

  /// The log of a weight over the sum.
  double operator()(double log_weight) const { return log_weight - first - second; }
};

/// @throws InvalidInput as checked_log_total
LogScale checked_log_scale(std::span<const double> log_weights);

}  // namespace internal

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
