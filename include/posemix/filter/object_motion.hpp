// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <variant>

#include "posemix/base/linear.hpp"
#include "posemix/base/words.hpp"
#include "posemix/lie/lie.hpp"

/// How an object moves: models, and the prediction of its pose and twist by one of them
/// (docs/moving-objects.md, "Motion models").
namespace posemix {

using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// The axes in which the motion of an object is stated. In both cases it is about the object's
/// origin, so that neither depends on where the origin of the world is.
enum class MotionFrame {
  object,  ///< along the object's axes, T <- T Exp(n): a constant twist is a screw motion, as of a
           ///< vehicle or of what a hand turns
  world  ///< along the world's axes, R <- Exp(n_rotation) R and p <- p + n_translation for T = (R,
         ///< p): with a constant twist the origin goes straight on while the object turns, as on
         ///< a conveyor or in free flight
};

/// The words of MotionFrame in files and options.
template <>
inline constexpr WordTable<MotionFrame, 2> words<MotionFrame>{{
    {"object", MotionFrame::object},
    {"world", MotionFrame::world},
}};

/// The object stands still.
struct StaticMotion {};

/// The object stands still until somebody moves it: jumps at a rate, each to a pose that is uniform
/// over all rotations and a volume.
struct PutDownMotion {
  double jump_rate = 0.02;  ///< [1/s]
  double volume_m3 = 1.0;   ///< in which it may be put down
};

/// The pose changes by independent steps of the covariance diag(sds^2) dt.
struct RandomWalkMotion {
  /// [rad / s^(1/2), m / s^(1/2)], rotation first.
  Vector6d sds = Vector6d::Constant(0.1);
  MotionFrame frame = MotionFrame::object;
  double break_rate = 0.02;  ///< as ConstantVelocityMotion::break_rate
};

/// A twist [rad/s, m/s] that is constant up to white acceleration, d twist = diag(acceleration_sds)
/// dW: after dt seconds it has changed by a standard deviation of acceleration_sds dt^(1/2).
struct ConstantVelocityMotion {
  /// [rad / s^(3/2), m / s^(3/2)], rotation first.
  Vector6d acceleration_sds = Vector6d::Constant(1.0);
  MotionFrame frame = MotionFrame::object;
  /// Standard deviations of the twist of an object of which no motion is known: one that is seen
  /// for the first time, or begins to move [rad/s, m/s].
  Vector6d start_sds = (Vector6d() << 2.0, 2.0, 2.0, 0.5, 0.5, 0.5).finished();
  /// Rate at which the motion is not what the model says [1/s]: one half of the times the object is
  /// at its place in any orientation, the other half anywhere. A filter that lost the object finds
  /// it again.
  double break_rate = 0.02;
};

/// The object is held by a frame whose pose T_world_frame is known at every time, such as a gripper
/// or a hand: T_frame_object is constant up to a random walk.
struct AttachedMotion {
  std::size_t frame = 0;  ///< index among the frames that are given
  /// Of the object in the grip, along the object's axes [rad / s^(1/2), m / s^(1/2)].
  Vector6d slip_sds = Vector6d::Zero();
};

/// A model of how one object moves.
using ObjectMotion = std::variant<StaticMotion, PutDownMotion, RandomWalkMotion,
                                  ConstantVelocityMotion, AttachedMotion>;

/// The name of a model: "static", "put_down", "random_walk", "constant_velocity", "attached".
std::string_view name_of(const ObjectMotion& motion);

/// @throws InvalidInput naming the number when one is negative or not finite, or a volume is not
/// positive
void validate(const ObjectMotion& motion);

/// The frame of the twist that is a part of the model's state; none for models without.
std::optional<MotionFrame> twist_frame(const ObjectMotion& motion);

/// Pose and twist of an object with their Gaussian: T = Exp(xi) T0 with xi in the world's frame,
/// and twist = twist0 + beta.
struct MotionState {
  SE3d pose = {};  ///< T_world_object
  /// [rad/s, m/s] in the frame of the model; zero for models without.
  Vector6d twist = Vector6d::Zero();
  /// Of [xi; beta]; the rows of beta are zero for models without.
  Matrix12d covariance = Matrix12d::Zero();
};

/// The state after some time, P <- F P F^T + Q.
struct MotionPrediction {
  MotionState state;
  Matrix12d jacobian;  ///< F, in the tangent spaces at the means before and after
  Matrix12d noise;     ///< Q
};

/// The state after `dt` seconds. The mean follows the motion without noise exactly; F and Q are
/// those of the linearised stochastic differential equation along it, exactly. Jumps and breaks
/// at a rate are not part of it: the prediction is that there was none. For an attached object
/// `frame_motion` is what the frame did in the world, T_world_frame(after)
/// T_world_frame(before)^-1; its covariance is that of an exact frame.
/// @throws InvalidInput when dt is negative, or anything is not finite
MotionPrediction predict(const MotionState& state, const ObjectMotion& motion, double dt,
                         const SE3d& frame_motion = {});

/// The state of the model `from` as one of the model `to`, with the Jacobian of the change in
/// `jacobian` where it is not null. A twist is turned into the other frame, dropped, or begun at
/// zero with start_sds.
MotionState as_state_of(const MotionState& state, const ObjectMotion& from, const ObjectMotion& to,
                        Matrix12d* jacobian = nullptr);

}  // namespace posemix
