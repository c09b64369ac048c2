// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "dependence.hpp"

#include <algorithm>
#include <cmath>

namespace posemix::internal {
namespace {

/// A variance from fewer blocks is too uncertain.
constexpr std::uint64_t kFewestBlocks = 6;

}  // namespace

void DependentFrames::add(const Vector6d& residual) {
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

double DependentFrames::estimate(double prior, double prior_frames) const {
  if (std::isinf(prior_frames) || levels_.empty() || levels_.front().squares <= 0.0) return prior;
  const auto frames = static_cast<double>(levels_.front().blocks);
  const double single = levels_.front().squares / frames;
  double most = 1.0;
  double length = 1.0;
  for (const Level& level : levels_) {
    if (level.blocks < kFewestBlocks) break;
    most = std::max(most, length * level.squares / static_cast<double>(level.blocks) / single);
    length *= 2.0;
  }
  return (prior_frames * prior + frames * most) / (prior_frames + frames);
}

}  // namespace posemix::internal
