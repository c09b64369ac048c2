// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

/// Weights as logarithms.
namespace posemix {

/// log(exp(a_0) + exp(a_1) + ...) without overflow or underflow; -inf for no terms or when all are
/// -inf.
double log_sum_exp(std::span<const double> terms);

/// The log of the sum of the weights.
/// @throws InvalidInput when a log-weight is NaN or +inf, or all weights are zero
double checked_log_total(std::span<const double> log_weights);

}  // namespace posemix
