// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "prediction_reach.hpp"

#include <cmath>
#include <utility>

#include "filter/precision.hpp"
#include "filter/world_shift.hpp"

namespace posemix::internal {
namespace {

/// Longest way of the mean, in reaches.
constexpr double kLongestWay = 100.0;
/// After so many halves nothing is left of a time.
constexpr int kMostHalves = 60;
/// Of the time that is left, so that the reach is nearly reached.
constexpr int kRefinements = 6;

/// About the object's own place, where errors of its rotation do not move it.
Matrix6d covariance_there(const MotionState& state) {
  const WorldShift to_there(-state.pose.translation());
  return to_there(Matrix6d(state.covariance.topLeftCorner<6, 6>()));
}

/// Also the way is bounded: rounding moves the errors of what is far from where it was.
bool is_within(double reach, const MotionState& before, const MotionState& after) {
  const Eigen::Vector3d way = after.pose.translation() - before.pose.translation();
  if (!(way.norm() <= kLongestWay * reach) || !after.covariance.allFinite()) return false;
  const Eigen::Vector3d variances = covariance_there(after).diagonal().tail<3>();
  return variances.minCoeff() >= 0.0 && variances.maxCoeff() <= reach * reach;
}

/// Whether there is hardly any time left, which need not be looked for in every frame.
bool has_arrived(double reach, const MotionState& state) {
  constexpr double kNearly = 0.98;
  return covariance_there(state).diagonal().tail<3>().maxCoeff() > kNearly * reach * reach;
}

/// xi <- D xi, where D shortens the rotation about the object's own place.
void limit_rotation(MotionPrediction& prediction) {
  MotionState& state = prediction.state;
  const double variance = state.covariance.diagonal().head<3>().maxCoeff();
  if (!(variance > kWidestRotation_rad * kWidestRotation_rad)) return;
  const WorldShift to_there(-state.pose.translation());
  Matrix6d shorter = Matrix6d::Identity();
  to_there.move_rows(shorter);
  shorter.topRows<3>() *= kWidestRotation_rad / std::sqrt(variance);
  to_there.inverse().move_rows(shorter);
  Matrix12d d = Matrix12d::Identity();
  d.topLeftCorner<6, 6>() = shorter;
  prediction.jacobian = (d * prediction.jacobian).eval();
  for (Matrix12d* p : {&prediction.noise, &state.covariance}) {
    *p = (d * *p * d.transpose()).eval();
    symmetrize(*p);
  }
}

}  // namespace

MotionPrediction predicted_within(double reach, const MotionState& state,
                                  const ObjectMotion& motion, double dt, const SE3d& frame_motion) {
  if (has_arrived(reach, state)) dt = 0.0;
  MotionPrediction result = posemix::predict(state, motion, dt, frame_motion);
  double beyond = dt;
  for (int halves = 1; !is_within(reach, state, result.state) && dt > 0.0; ++halves) {
    beyond = dt;
    dt = halves < kMostHalves ? 0.5 * dt : 0.0;
    result = posemix::predict(state, motion, dt, frame_motion);
  }
  for (int k = 0; k < kRefinements && beyond > dt; ++k) {
    const double longer = 0.5 * (dt + beyond);
    MotionPrediction further = posemix::predict(state, motion, longer, frame_motion);
    const bool is_in = is_within(reach, state, further.state);
    (is_in ? dt : beyond) = longer;
    if (is_in) result = std::move(further);
  }
  limit_rotation(result);
  return result;
}

}  // namespace posemix::internal
