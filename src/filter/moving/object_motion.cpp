// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/object_motion.hpp"

#include <cmath>
#include <string>

#include "posemix/base/limits.hpp"
#include "posemix/base/range.hpp"

namespace posemix {
namespace {

/// Terms of the power series; with angles below one radian twenty are enough.
constexpr int kMostTerms = 60;

Matrix6d block_diagonal(const Eigen::Matrix3d& rotation, const Eigen::Matrix3d& translation) {
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = rotation;
  m.bottomRightCorner<3, 3>() = translation;
  return m;
}

Matrix6d variances(const Vector6d& sds) { return sds.cwiseAbs2().asDiagonal(); }

/// The axes in which noise of a frame is stated, as a pose in the world: perturbations along them
/// are xi = Ad(axes) zeta.
SE3d axes_of(MotionFrame frame, const SE3d& pose) {
  return frame == MotionFrame::object ? pose : SE3d(SO3d(), pose.translation());
}

/// Pose and twist along the axes of the motion: d zeta = B zeta dt + beta dt with a constant B, and
/// d beta = diag(sds) dW. What follows is what they are after dt seconds.
struct LinearMotion {
  Matrix6d b;       ///< B dt
  Matrix6d pose;    ///< exp(B dt)
  Matrix6d twist;   ///< int_0^dt exp(B s) ds
  SE3d axes_after;  ///< the axes of zeta after dt seconds
};

/// docs/moving-objects.md, eq. (2) to (4).
LinearMotion linear_motion(const MotionState& state, MotionFrame frame, double dt, SE3d& after) {
  const Vector6d moved = dt * state.twist;
  LinearMotion m;
  if (frame == MotionFrame::object) {
    after = state.pose * SE3d::exp(moved);
    m.b = -SE3d::ad(moved);
    m.pose = SE3d::exp(-moved).adjoint();
    m.twist = dt * SE3d::right_jacobian(moved);
  } else {
    const Eigen::Vector3d angle = moved.head<3>();
    const SO3d turn = SO3d::exp(angle);
    after = SE3d(turn * state.pose.rotation(), state.pose.translation() + moved.tail<3>());
    m.b = block_diagonal(SO3d::hat(angle), Eigen::Matrix3d::Zero());
    m.pose = block_diagonal(turn.matrix(), Eigen::Matrix3d::Identity());
    m.twist = dt * block_diagonal(SO3d::left_jacobian(angle), Eigen::Matrix3d::Identity());
  }
  m.axes_after = axes_of(frame, after);
  return m;
}

/// Q of [zeta; beta] for the covariance q = diag(sds^2) dt that the twist gains, eq. (5): with C =
/// Cov(zeta, beta) and D = Cov(zeta), C' = B C + q t and D' = B D + D B^T + C + C^T, as power
/// series in the time, of which every coefficient follows from the one before.
Matrix12d series_noise(const Matrix6d& b, const Matrix6d& q, double dt) {
  Matrix6d c_term = 0.5 * dt * q;  // of the second power of the time
  Matrix6d d_term = Matrix6d::Zero();
  Matrix6d c = c_term;
  Matrix6d d = d_term;
  for (int k = 2; k < kMostTerms; ++k) {
    const double next = k + 1;
    const Matrix6d bd = b * d_term;
    d_term = (bd + bd.transpose() + dt * (c_term + c_term.transpose())) / next;
    c_term = (b * c_term / next).eval();
    c += c_term;
    d += d_term;
    if (c_term.cwiseAbs().maxCoeff() <= 1e-18 * c.cwiseAbs().maxCoeff() &&
        d_term.cwiseAbs().maxCoeff() <= 1e-18 * d.cwiseAbs().maxCoeff())
      break;
  }
  Matrix12d all;
  all << d, c, c.transpose(), q;
  return all;
}

/// The same for any angle: half of the time as often as needed, then Q <- F Q F^T + Q, eq. (6).
Matrix12d local_noise(const LinearMotion& m, const Vector6d& sds, double dt, double angle) {
  int halvings = 0;
  for (; std::ldexp(angle, -halvings) > 1.0; ++halvings) {
  }
  const double part = std::ldexp(1.0, -halvings);
  const Matrix6d b = part * m.b;
  Matrix12d noise = series_noise(b, part * dt * variances(sds), part * dt);
  if (halvings == 0) return noise;
  // exp(B t) and its integral over the part, by their series.
  Matrix6d power = Matrix6d::Identity();
  Matrix6d sum = power;
  Matrix6d integral = power;
  for (int k = 1; k < kMostTerms; ++k) {
    power = (power * b / k).eval();
    sum += power;
    integral += power / (k + 1);
  }
  Matrix12d f;
  f << sum, part * dt * integral, Matrix6d::Zero(), Matrix6d::Identity();
  for (int k = 0; k < halvings; ++k) {
    noise += (f * noise * f.transpose()).eval();
    f = (f * f).eval();
  }
  return noise;
}

MotionPrediction predict_velocity(const MotionState& state, const ConstantVelocityMotion& motion,
                                  double dt) {
  MotionPrediction result;
  result.state = state;
  const LinearMotion m = linear_motion(state, motion.frame, dt, result.state.pose);
  const Matrix6d before = axes_of(motion.frame, state.pose).inverse().adjoint();
  const Matrix6d after = m.axes_after.adjoint();
  result.jacobian.setIdentity();
  result.jacobian.topLeftCorner<6, 6>() = after * Matrix6d(m.pose * before);
  result.jacobian.topRightCorner<6, 6>() = after * m.twist;
  const double angle = dt * state.twist.head<3>().norm();
  const Matrix12d local = local_noise(m, motion.acceleration_sds, dt, angle);
  const Matrix6d d = after * local.topLeftCorner<6, 6>();
  const Matrix6d c = after * local.topRightCorner<6, 6>();
  result.noise << d * after.transpose(), c, c.transpose(), local.bottomRightCorner<6, 6>();
  return result;
}

struct Predictor {
  const MotionState& state;
  double dt;
  const SE3d& frame_motion;

  MotionPrediction still() const {
    MotionPrediction result{state, Matrix12d::Zero(), Matrix12d::Zero()};
    result.state.twist.setZero();
    result.jacobian.topLeftCorner<6, 6>().setIdentity();
    return result;
  }
  MotionPrediction operator()(const StaticMotion&) const { return still(); }
  MotionPrediction operator()(const PutDownMotion&) const { return still(); }
  MotionPrediction operator()(const RandomWalkMotion& motion) const {
    MotionPrediction result = still();
    result.noise.topLeftCorner<6, 6>() =
        axes_of(motion.frame, state.pose).adjoint_congruence(variances(motion.sds) * dt);
    return result;
  }
  MotionPrediction operator()(const ConstantVelocityMotion& motion) const {
    return predict_velocity(state, motion, dt);
  }
  MotionPrediction operator()(const AttachedMotion& motion) const {
    MotionPrediction result = still();
    result.state.pose = frame_motion * state.pose;
    result.jacobian.topLeftCorner<6, 6>() = frame_motion.adjoint();
    result.noise.topLeftCorner<6, 6>() =
        result.state.pose.adjoint_congruence(variances(motion.slip_sds) * dt);
    return result;
  }
};

/// J P J^T for a J whose lower left block is zero and whose lower right one is diagonal: products
/// of large matrices cost much more than those of their blocks.
Matrix12d propagated(const Matrix12d& j, const Matrix12d& p) {
  const Matrix6d a = j.topLeftCorner<6, 6>();
  const Matrix6d b = j.topRightCorner<6, 6>();
  const Vector6d kept = j.bottomRightCorner<6, 6>().diagonal();
  Matrix12d result;
  if (b.isZero(0.0)) {
    const Matrix6d ap = a * p.topLeftCorner<6, 6>();
    result.topLeftCorner<6, 6>() = ap * a.transpose();
    const Matrix6d cross = a * p.topRightCorner<6, 6>();
    result.topRightCorner<6, 6>() = cross * kept.asDiagonal();
  } else {
    Matrix6d x = a * p.topLeftCorner<6, 6>();
    x += b * p.bottomLeftCorner<6, 6>();
    Matrix6d y = a * p.topRightCorner<6, 6>();
    y += b * p.bottomRightCorner<6, 6>();
    Matrix6d pose = x * a.transpose();
    pose += y * b.transpose();
    result.topLeftCorner<6, 6>() = pose;
    result.topRightCorner<6, 6>() = y * kept.asDiagonal();
  }
  result.bottomLeftCorner<6, 6>() = result.topRightCorner<6, 6>().transpose();
  result.bottomRightCorner<6, 6>() =
      kept.asDiagonal() * p.bottomRightCorner<6, 6>() * kept.asDiagonal();
  return result;
}

void check_sds(const Vector6d& sds, const char* name) {
  for (const double sd : sds) kStandardDeviation.check(sd, name);
}

struct MotionCheck {
  void operator()(const StaticMotion&) const {}
  void operator()(const PutDownMotion& motion) const {
    kNotNegative.check(motion.jump_rate, "put_down: jump_rate");
    kPositive.check(motion.volume_m3, "put_down: volume_m3");
  }
  void operator()(const RandomWalkMotion& motion) const {
    check_sds(motion.sds, "random_walk: sds");
    kNotNegative.check(motion.break_rate, "random_walk: break_rate");
  }
  void operator()(const ConstantVelocityMotion& motion) const {
    check_sds(motion.acceleration_sds, "constant_velocity: acceleration_sds");
    check_sds(motion.start_sds, "constant_velocity: start_sds");
    kNotNegative.check(motion.break_rate, "constant_velocity: break_rate");
  }
  void operator()(const AttachedMotion& motion) const {
    check_sds(motion.slip_sds, "attached: slip_sds");
  }
};

struct MotionName {
  std::string_view operator()(const StaticMotion&) const { return "static"; }
  std::string_view operator()(const PutDownMotion&) const { return "put_down"; }
  std::string_view operator()(const RandomWalkMotion&) const { return "random_walk"; }
  std::string_view operator()(const ConstantVelocityMotion&) const { return "constant_velocity"; }
  std::string_view operator()(const AttachedMotion&) const { return "attached"; }
};

}  // namespace

std::string_view name_of(const ObjectMotion& motion) { return std::visit(MotionName{}, motion); }

void validate(const ObjectMotion& motion) { std::visit(MotionCheck{}, motion); }

std::optional<MotionFrame> twist_frame(const ObjectMotion& motion) {
  const auto* velocity = std::get_if<ConstantVelocityMotion>(&motion);
  return velocity ? std::optional(velocity->frame) : std::nullopt;
}

MotionPrediction predict(const MotionState& state, const ObjectMotion& motion, double dt,
                         const SE3d& frame_motion) {
  kNotNegative.check(dt, "predict: dt");
  require(state.pose.matrix().allFinite() && state.twist.allFinite() &&
              state.covariance.allFinite() && frame_motion.matrix().allFinite(),
          "predict: the state or the frame's motion holds a value that is not finite");
  MotionPrediction result = std::visit(Predictor{state, dt, frame_motion}, motion);
  symmetrize(result.noise);
  result.state.covariance = propagated(result.jacobian, state.covariance) + result.noise;
  symmetrize(result.state.covariance);
  return result;
}

/// With T = (R, p) the twist along the world's axes is [R w; R v]: the velocity is that of the
/// object's origin in both frames.
MotionState as_state_of(const MotionState& state, const ObjectMotion& from, const ObjectMotion& to,
                        Matrix12d* jacobian) {
  const auto had = twist_frame(from);
  const auto* velocity = std::get_if<ConstantVelocityMotion>(&to);
  Matrix12d f = Matrix12d::Identity();
  MotionState result = state;
  if (jacobian) *jacobian = f;
  if (had && velocity && *had == velocity->frame) return result;
  if (!had || !velocity) f.bottomRightCorner<6, 6>().setZero();
  if (had && velocity && *had != velocity->frame) {
    const bool to_world = velocity->frame == MotionFrame::world;
    const Eigen::Matrix3d r = state.pose.rotation().matrix();
    const Eigen::Matrix3d turn = to_world ? r : Eigen::Matrix3d(r.transpose());
    for (const Eigen::Index k : {0, 3}) {
      const Eigen::Vector3d before = state.twist.segment<3>(k);
      result.twist.segment<3>(k) = turn * before;
      f.block<3, 3>(6 + k, 6 + k) = turn;
      f.block<3, 3>(6 + k, 0) = to_world ? Eigen::Matrix3d(-SO3d::hat(turn * before))
                                         : Eigen::Matrix3d(turn * SO3d::hat(before));
    }
  }
  if (had && velocity) result.covariance = f * state.covariance * f.transpose();
  if (!had || !velocity) {
    result.twist.setZero();
    result.covariance.topRightCorner<6, 6>().setZero();
    result.covariance.bottomRows<6>().setZero();
  }
  if (!had && velocity)
    result.covariance.bottomRightCorner<6, 6>() = variances(velocity->start_sds);
  if (jacobian) *jacobian = f;
  return result;
}

}  // namespace posemix
