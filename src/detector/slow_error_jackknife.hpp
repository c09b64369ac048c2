// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "posemix/base/linear.hpp"

/// Standard errors of an estimate of maximum likelihood.
namespace posemix::internal {

/// The log-likelihood of every track for a vector of parameters.
using LikelihoodByTrack = std::function<std::vector<double>(std::span<const double>)>;

/// Standard errors of the parameters that are free, at the maximum of the likelihood; NaN for the
/// others, and for all where the maximum is flat. A jackknife leaves out the tracks of one
/// recording at a time and finds the new maximum by one Newton step; without it they are the root
/// of the diagonal of the inverse negative Hessian. Derivatives are differences of the likelihood.
Eigen::VectorXd log_parameter_errors(const LikelihoodByTrack& likelihood,
                                     std::span<const std::size_t> recordings,
                                     std::span<const double> x, const std::vector<bool>& is_free,
                                     bool is_jackknife);

/// The maximum of the likelihood near x, by Newton steps of the free parameters with the Hessian at
/// x, until they do not move: x itself where that is flat or the steps lead away.
std::vector<double> polished(const LikelihoodByTrack& likelihood, std::vector<double> x,
                             const std::vector<bool>& is_free);

}  // namespace posemix::internal
