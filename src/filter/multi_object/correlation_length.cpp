// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "correlation_length.hpp"

#include <algorithm>
#include <cmath>

namespace posemix::internal {
namespace {

/// The variance of fewer blocks is too uncertain.
constexpr std::uint64_t kFewestBlocks = 6;

}  // namespace

void CorrelationLength::add(const Vector6d& residual) {
  Vector6d mean = residual;
  for (std::size_t level = 0;; ++level) {
    if (level == levels_.size()) levels_.emplace_back();
    Level& at = levels_[level];
    ++at.blocks;
    at.squares += mean.squaredNorm();
    if (!at.has_pending) {
      at.pending = mean;
      at.has_pending = true;
      return;
    }
    mean = 0.5 * (at.pending + mean);
    at.has_pending = false;
  }
}

double CorrelationLength::estimate(double prior, double prior_residuals) const {
  if (std::isinf(prior_residuals) || levels_.empty() || levels_.front().squares <= 0.0)
    return prior;
  const auto residuals = static_cast<double>(levels_.front().blocks);
  const double single = levels_.front().squares / residuals;
  double most = 1.0;
  double length = 1.0;
  for (const Level& level : levels_) {
    if (level.blocks < kFewestBlocks) break;
    most = std::max(most, length * level.squares / static_cast<double>(level.blocks) / single);
    length *= 2.0;
  }
  return (prior_residuals * prior + residuals * most) / (prior_residuals + residuals);
}

}  // namespace posemix::internal
