// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "posemix/filter/object_motion.hpp"

namespace posemix {

/// The ways in which one object may move, and how it changes between them: a Markov chain.
struct MotionModels {
  std::vector<ObjectMotion> models = {StaticMotion{}};
  /// Square, one row per model: the rate at which an object that moves by the model of the row
  /// begins to move by that of the column [1/s]. The diagonal is not looked at. Empty: no changes.
  Eigen::MatrixXd rates = {};
  /// Probability of each model for an object that is seen for the first time. Empty: equal ones.
  std::vector<double> start = {};
};

/// The motion of what hands, vehicles or robots move: calm for a second on average, then for a
/// third of one with five times the acceleration.
MotionModels calm_and_agile(const ConstantVelocityMotion& calm = {});

/// @throws InvalidInput when there is no model, one is not valid, a rate or a probability is out of
/// range, or sizes differ
void validate(const MotionModels& models);

}  // namespace posemix
