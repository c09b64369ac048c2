// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>

#include "study.hpp"

namespace posemix {

/// Consistency of one kind of pose in one recording, over the moments at which it was looked at.
struct PoseConsistency {
  double nees = 0.0;  ///< mean NEES per degree of freedom
  /// Shares of the moments with the truth within 1, 2 and 3 sigma: the part of the chi-square
  /// distribution that a normal deviate has within them.
  std::array<double, 3> covered{};
  std::size_t count = 0;
};

/// The result of one recording.
struct ConsistencyTrial {
  PoseConsistency camera;
  PoseConsistency object;    ///< T_world_object, on the right mode
  PoseConsistency relative;  ///< T_camera_object, on the right mode
  double mode_probability = 0.0;
  double right_mode = 0.0;    ///< share of the moments on the right mode
  double rotation_deg = 0.0;  ///< mean error of T_camera_object, on whatever mode
  double position_m = 0.0;    ///< the same of its translation
  std::size_t duplicates = 0;
  std::size_t instances = 0;  ///< known instances that could be duplicated
};

/// One recording of a kind, filtered by the defaults.
ConsistencyTrial run_consistency_trial(const ConsistencyCell& cell, std::uint64_t seed,
                                       std::uint64_t run);

}  // namespace posemix
