// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <vector>

#include "posemix/base/linear.hpp"

/// How many successive residuals say as much as one independent one. In the room `filter` only.
namespace posemix::internal {

/// Block averages of a sequence of white residuals over 1, 2, 4, ... of them: of independent ones
/// the variance falls with the length, so that length times variance, by the variance of single
/// ones, is the number that counts as one (Flyvbjerg and Petersen, J. Chem. Phys. 91, 1989).
class DependentFrames {
 public:
  void add(const Vector6d& residual);

  /// The largest over the lengths of which there are enough blocks, with `prior` as the mean of
  /// `prior_frames` imagined frames.
  double estimate(double prior, double prior_frames) const;

 private:
  struct Level {
    Vector6d pending = Vector6d::Zero();
    bool has_pending = false;
    std::uint64_t blocks = 0;
    double squares = 0.0;  ///< sum over blocks of the squared norm of their mean
  };

  std::vector<Level> levels_;
};

}  // namespace posemix::internal
