// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include "posemix/slam/consistency.hpp"

/// Estimates and true poses of the same times.
namespace posemix {

struct StampedEstimate {
  double stamp_s = 0.0;
  PoseDensity estimate;
};

struct StampedTruth {
  double stamp_s = 0.0;
  SE3d pose;
};

/// How estimates are moved onto the truth before they are compared.
enum class Alignment {
  none,
  first,  ///< the first pair agrees, which then does not count
  se3     ///< the rigid motion of least squared distance of the positions
};

/// The words of Alignment in options.
template <>
inline constexpr WordTable<Alignment, 3> words<Alignment>{{
    {"none", Alignment::none},
    {"first", Alignment::first},
    {"se3", Alignment::se3},
}};

struct MatchSettings {
  double max_difference_s = 0.01;  ///< between the stamps of estimate and truth; 0: equal ones
  Alignment alignment = Alignment::none;
};

/// The pairs of estimate and truth that are nearest in time to one another, in order of time; each
/// is in one pair. Of several that are as near, those are taken that leave the fewest alone, the
/// earliest first.
///
/// An alignment X -> A X moves poses and covariances, Ad(A) P Ad(A)^T, and takes out of the error
/// what it absorbs: the error of the first pose, or the mean error of all. The covariances do not
/// know that. After `first` they should be those relative to the first pose.
/// @throws InvalidInput for a largest difference that is negative or not finite, stamps that do not
/// increase strictly or are no numbers, fewer than two pairs (with the ranges of the stamps), and
/// `se3` for positions that are on a line
std::vector<EstimateWithTruth> match_to_truth(std::span<const StampedEstimate> estimates,
                                              std::span<const StampedTruth> truth,
                                              const MatchSettings& settings = {});

}  // namespace posemix
