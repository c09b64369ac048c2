// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/filter/object_motion.hpp"

/// How far a motion model predicts: the longer an object is not seen, the less a double holds of
/// the detection that ends it.
namespace posemix::internal {

/// The state after `dt` seconds, or after nearly all of the part of them in which the position's
/// standard deviation stays within the reach, and its mean within a hundred of it: farther, the
/// model says nothing more of a detection. Standard deviations of a rotation end at 100 rad, as all
/// rotations are within a turn.
MotionPrediction predicted_within(double reach, const MotionState& state,
                                  const ObjectMotion& motion, double dt, const SE3d& frame_motion);

}  // namespace posemix::internal
