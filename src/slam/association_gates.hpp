// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/slam/association.hpp"

namespace posemix::internal {

/// Squared distances.
struct AssociationGates {
  double position;  ///< the largest at which a detection can be of an instance
  double rotation;  ///< the most that a rotation costs
};

/// @throws InvalidInput when a setting is out of range
inline AssociationGates gates_of(const AssociationSettings& settings) {
  kOpenUnitInterval.check(settings.certain_probability, "certain_probability");
  kNotNegative.check(settings.least_separation_m, "least_separation_m");
  require(!std::isnan(settings.least_new_score), "least_new_score is nan, expected a number");
  require(settings.joint_assignments > 0, "joint_assignments is 0, expected at least 1");
  return {chi_square_quantile(settings.gate_probability, 3, "gate_probability"),
          chi_square_quantile(settings.rotation_cap_probability, 3, "rotation_cap_probability")};
}

}  // namespace posemix::internal
