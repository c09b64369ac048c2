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
  return log_sum_exp(terms.size(), [&](std::size_t i) { return terms[i]; });
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

internal::LogScale internal::checked_log_scale(std::span<const double> log_weights) {
  constexpr double kFar = 1e3;  // whose last digit is 1e-13
  const double total = checked_log_total(log_weights);
  if (std::abs(total) <= kFar) return {total, 0.0};
  const double largest = *std::max_element(log_weights.begin(), log_weights.end());
  const double rest =
      log_sum_exp(log_weights.size(), [&](std::size_t i) { return log_weights[i] - largest; });
  return {largest, rest};
}

}  // namespace posemix
