// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <vector>

#include "posemix/base/linear.hpp"

namespace posemix::internal {

/// Estimates the correlation length of a sequence of white residuals: the number of successive ones
/// that carry as much information as one independent residual.
///
/// Residuals are averaged over blocks of 1, 2, 4, ... of them. The variance of such averages falls
/// with the length of the blocks where residuals are independent, so that length times variance,
/// divided by the variance of single residuals, is the correlation length (Flyvbjerg and Petersen,
/// J. Chem. Phys. 91, 1989).
class CorrelationLength {
 public:
  void add(const Vector6d& residual);

  /// The largest estimate over all lengths with enough blocks, averaged with `prior`, which counts
  /// as `prior_residuals` residuals.
  double estimate(double prior, double prior_residuals) const;

 private:
  struct Level {
    Vector6d pending = Vector6d::Zero();  ///< the first average of an incomplete pair
    bool has_pending = false;
    std::uint64_t blocks = 0;
    double squares = 0.0;  ///< sum of the squared norms of the blocks' averages
  };

  std::vector<Level> levels_;  ///< blocks of 1, 2, 4, ... residuals
};

}  // namespace posemix::internal
