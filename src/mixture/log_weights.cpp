// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/log_weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {

double log_sum_exp(std::span<const double> terms) {
  constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();
  if (terms.empty()) return kMinusInfinity;
  const double largest = *std::max_element(terms.begin(), terms.end());
  if (std::isinf(largest)) return largest;
  double sum = 0.0;
  for (const double term : terms) sum += std::exp(term - largest);
  return largest + std::log(sum);
}

void check_log_weights(std::span<const double> log_weights) {
  for (std::size_t i = 0; i < log_weights.size(); ++i) {
    if (std::isnan(log_weights[i]) || log_weights[i] == std::numeric_limits<double>::infinity()) {
      throw InvalidInput(
          fmt::format("log-weight {} is {}, expected a number or -inf", i, log_weights[i]));
    }
  }
}

double checked_log_total(std::span<const double> log_weights) {
  check_log_weights(log_weights);
  const double total = log_sum_exp(log_weights);
  require(std::isfinite(total), "all weights are zero");
  return total;
}

}  // namespace posemix
