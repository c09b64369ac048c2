// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>

namespace posemix::internal {

/// h - 1 + exp(-h), without cancellation.
inline double excess(double h) {
  if (std::abs(h) > 0.02) return h + std::expm1(-h);
  return h * h * (0.5 - h * (1.0 / 6.0 - h * (1.0 / 24.0 - h * (1.0 / 120.0 - h / 720.0))));
}

/// The factor of the sampling density in the integrand of a divergence, as a function of log p and
/// log q. Below, s = (p + q) / 2.
using DensityFactor = double (*)(double log_p, double log_q);

/// log(p/q): its integrals over the peaks of p sum to int p log(p/q).
inline double log_ratio(double log_p, double log_q) { return log_p - log_q; }

/// p - q: its integrals over the peaks of p, less those over the peaks of q, sum to int (p - q)^2.
inline double density_gap(double log_p, double log_q) { return std::exp(log_p) - std::exp(log_q); }

/// (p log(p/q) - p + q) / s, the non-negative form for int p log(p/q).
inline double gap_factor(double log_p, double log_q) {
  const double h = log_p - log_q;
  if (h > -0.02) return 2.0 * excess(h) / (1.0 + std::exp(-h));
  const double e = std::exp(h);
  return 2.0 * (h * e - std::expm1(h)) / (1.0 + e);
}

/// (p - q) log(p/q) / s, for the symmetric divergence.
inline double symmetric_factor(double log_p, double log_q) {
  const double h = log_p - log_q;
  return 2.0 * h * std::tanh(0.5 * h);
}

/// (p - q)^2 / s, for the integral square distance.
inline double square_factor(double log_p, double log_q) {
  const double down = -std::abs(log_p - log_q);
  const double change = std::expm1(down);
  return 2.0 * std::exp(std::max(log_p, log_q)) * change * change / (2.0 + change);
}

}  // namespace posemix::internal
