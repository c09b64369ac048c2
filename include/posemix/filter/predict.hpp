// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/filter/update.hpp"

/// How the camera moves between two frames. Objects stand still. Every noise is a right
/// perturbation of the camera pose, so its covariance Q (already multiplied by the time step) is in
/// the camera frame and enters the covariance as P_RR += Ad(T_R) Q Ad(T_R)^T. The functions throw
/// InvalidInput as check_pose for the motion and as check_noise for the noise, for a step that is
/// not finite or beyond kLatestStamp, and for a hypothesis without the poses that are moved.
namespace posemix {

/// Index of the pose that holds the camera's motion per reference period, for constant velocity.
inline constexpr std::size_t kMotion = 1;

/// Odometry (midway-merge paper, eq. 31): T_R <- T_R motion. The error xi_R of the world frame does
/// not change.
Hypothesis predict_with_odometry(Hypothesis hypothesis, const SE3d& motion, const Matrix6d& q);

/// Random walk: the mean stays.
Hypothesis predict_random_walk(Hypothesis hypothesis, const Matrix6d& q);

/// Constant velocity: the pose at kMotion, a part of the state, is the motion V of the camera in
/// one reference period,
///   T_R <- T_R Exp(s Log V) Exp(n),  V <- V Exp(n_v),
/// with s the step in reference periods. xi_R <- xi_R + Ad(T_R) s J_l(s v) J_l^-1(v) xi_V with v =
/// Log V, which for s = 1 is the exact Ad(T_R) xi_V.
Hypothesis predict_constant_velocity(Hypothesis hypothesis, double periods, const Matrix6d& q,
                                     const Matrix6d& q_motion);

/// The factor of xi_V in xi_R in predict_constant_velocity, Ad(T_R) s J_l(s v) J_l^-1(v).
Matrix6d constant_velocity_transfer(const SE3d& camera, const SE3d& motion, double periods);

}  // namespace posemix
