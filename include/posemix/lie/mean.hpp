// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/lie/concept.hpp"

namespace posemix {

/// Stopping criteria of weighted_mean.
struct MeanSettings {
  int max_iterations = 100;
  /// Largest norm of the mean tangent vector at which the iteration has converged [rad, m]; if
  /// rounding errors are larger, their size is used instead.
  double tolerance = 1e-12;
};

/// Result of weighted_mean. If it has not converged, `mean` is the last iterate.
template <LieGroup G>
struct MeanResult {
  G mean;
  bool converged = false;
  int iterations = 0;               ///< updates of the mean
  typename G::Scalar residual = 0;  ///< |sum w_i log(mean^-1 X_i)| [rad, m]
};

/// Checks the weights of a mean and returns their sum.
/// @throws InvalidInput unless there is one weight for each of `count` > 0 elements, all weights
/// are finite and not negative, and their sum is positive and finite
template <typename Scalar>
Scalar checked_weight_sum(std::size_t count, std::span<const Scalar> weights) {
  if (count == 0) throw InvalidInput("weighted mean of no elements");
  if (weights.size() != count) {
    throw InvalidInput(
        fmt::format("weighted mean of {} elements with {} weights; expected one for each", count,
                    weights.size()));
  }
  Scalar sum(0);
  for (std::size_t i = 0; i < count; ++i) {
    if (!(weights[i] >= Scalar(0)) || weights[i] > std::numeric_limits<Scalar>::max()) {
      throw InvalidInput(fmt::format(
          "weight {} of a weighted mean is {:.6g}; expected a finite number, zero or more", i,
          static_cast<double>(weights[i])));
    }
    sum += weights[i];
  }
  if (!(sum > Scalar(0))) throw InvalidInput("weights of a weighted mean sum to zero");
  if (sum > std::numeric_limits<Scalar>::max())
    throw InvalidInput("weights of a weighted mean overflow");
  return sum;
}

/// The weighted mean of group elements: sum w_i log(X_i mean^-1) = 0, for weights normalised to sum
/// one.
///
/// Iterates mean <- exp(sum w_i log(X_i mean^-1)) mean from the element of largest weight (the
/// first of equals), in the equivalent form mean exp(sum w_i log(mean^-1 X_i)). On SO(3) this is
/// the Karcher mean, on SE(3) the bi-invariant exponential barycentre: the mean of A X_i B is A
/// mean(X_i) B. It is unique if all rotations lie within less than pi/2 of it. Source: Pennec and
/// Arsigny, Exponential Barycenters of the Canonical Cartan Connection (2012), Algorithm 1.
/// @throws InvalidInput for no elements, and for weights as checked_weight_sum
template <LieGroup G>
MeanResult<G> weighted_mean(std::span<const G> elements,
                            std::span<const typename G::Scalar> weights,
                            const MeanSettings& settings = {}) {
  using Scalar = typename G::Scalar;
  const Scalar sum = checked_weight_sum(elements.size(), weights);
  const auto largest = std::max_element(weights.begin(), weights.end()) - weights.begin();
  MeanResult<G> result{elements[static_cast<std::size_t>(largest)]};
  while (true) {
    const G inverse = result.mean.inverse();
    typename G::Tangent step = G::Tangent::Zero(result.mean.dof());
    Scalar reach(0);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (!(weights[i] > Scalar(0))) continue;
      const typename G::Tangent tangent = (inverse * elements[i]).log();
      step += (weights[i] / sum) * tangent;
      reach = std::max(reach, Scalar(tangent.norm()));
    }
    result.residual = step.norm();
    const Scalar rounding = Scalar(4) * std::numeric_limits<Scalar>::epsilon() *
                            (Scalar(1) + reach + result.mean.log().norm());
    result.converged = result.residual <= std::max(Scalar(settings.tolerance), rounding);
    if (result.converged || result.iterations >= settings.max_iterations) return result;
    result.mean = result.mean * G::exp(step);
    ++result.iterations;
  }
}

/// weighted_mean of elements and weights in vectors.
template <LieGroup G>
MeanResult<G> weighted_mean(const std::vector<G>& elements,
                            const std::vector<typename G::Scalar>& weights,
                            const MeanSettings& settings = {}) {
  return weighted_mean<G>(std::span<const G>(elements),
                          std::span<const typename G::Scalar>(weights), settings);
}

}  // namespace posemix
