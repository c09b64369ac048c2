// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "observation_numbers.hpp"

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "detector/observation_ranges.hpp"
#include "posemix/io/rigid.hpp"

namespace posemix::internal {
namespace {

/// The square of the least standard deviation that a sequence file may state.
constexpr double kLeastVariance = 1e-18;

}  // namespace

std::string_view wrong_stamp(double stamp_s) {
  return std::abs(stamp_s) <= kLatestStamp
             ? ""
             : "seconds, at most 1e+12 (are these nano-, micro- or milliseconds?)";
}

std::string_view wrong_position(double coordinate_m) {
  return std::abs(coordinate_m) <= kFarthestPosition ? "" : "metres, at most 1e+08";
}

std::string_view wrong_weight(double weight) { return weight >= 0.0 ? "" : "zero or more"; }

std::string_view wrong_clutter(double probability) {
  if (probability > 0.0 && probability <= kMostClutter) return "";
  return probability > kMostClutter && probability <= 1.0
             ? "a probability above 0 and at most 1 - 1e-9 (leave out what is of no object)"
             : "a probability above 0 and at most 1 - 1e-9";
}

std::optional<CovarianceFault> fault_of(const Matrix6d& covariance) {
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double variance = covariance(i, i);
    if (variance >= kLeastVariance && variance <= kLargestVariance) continue;
    return CovarianceFault{fmt::format("c{}{} = {}", i, i, variance),
                           "a variance in [1e-18, 1e+16] (rad^2, m^2)"};
  }
  if (Eigen::LLT<Matrix6d>(covariance).info() == Eigen::Success) return std::nullopt;
  return CovarianceFault{"a covariance c00 ... c55 that is not positive definite", "one that is"};
}

}  // namespace posemix::internal
