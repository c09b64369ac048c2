// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Eigenvalues>

#include "filter/precision.hpp"
#include "multi_object_state.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/filter/predict.hpp"

namespace posemix::internal {
namespace {

/// A motion with less noise than this along every axis is taken as it is [rad^2, m^2].
constexpr double kLittleNoise = 1.0;

/// Of all detectors [m]. A camera drifts farther than a detector tells where an object moves, and
/// finds itself: ten times as far.
double shortest_reach(const std::vector<TrackedObject>& objects) {
  constexpr double kFarther = 10.0;
  double least = std::numeric_limits<double>::infinity();
  for (const TrackedObject& object : objects)
    for (const LearnedSensor& detector : object.detectors)
      least = std::min(least, position_reach(detector.sensor().noise));
  return kFarther * least;
}

/// What shortens the directions of a covariance in which it is wider, with what was before, than a
/// largest standard deviation. A hundredth of that is taken in any case, as a camera that is lost
/// in the world may be known beside an object.
Eigen::Matrix3d shortening(double largest, const Eigen::Matrix3d& before,
                           const Eigen::Matrix3d& covariance) {
  constexpr double kAlways = 0.01;
  const double most = largest * largest;
  const double left = std::max(kAlways * kAlways * most, most - before.diagonal().maxCoeff());
  if (covariance.diagonal().maxCoeff() <= left) return Eigen::Matrix3d::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const Eigen::Array3d factors = (left / axes.eigenvalues().array().max(left)).sqrt();
  return axes.eigenvectors() * factors.matrix().asDiagonal() * axes.eigenvectors().transpose();
}

}  // namespace

Matrix6d MultiObjectState::within_reach(const Matrix6d& covariance, const Matrix6d& before) const {
  constexpr double kRoundings = 64.0 * std::numeric_limits<double>::epsilon();
  Matrix6d shorter = Matrix6d::Zero();
  shorter.topLeftCorner<3, 3>() = shortening(kWidestRotation_rad, before.topLeftCorner<3, 3>(),
                                             covariance.topLeftCorner<3, 3>());
  shorter.bottomRightCorner<3, 3>() =
      shortening(shortest_reach(objects), before.bottomRightCorner<3, 3>(),
                 covariance.bottomRightCorner<3, 3>());
  if (shorter == Matrix6d::Identity()) return covariance;
  // What rounding of a wide direction leaves of the others, which would be negative else.
  const Vector6d sizes = shorter.cwiseAbs() * covariance.diagonal().cwiseSqrt();
  Matrix6d less = shorter * covariance * shorter;
  less.diagonal() += kRoundings * sizes.cwiseAbs2();
  symmetrize(less);
  return less;
}

Matrix6d MultiObjectState::within_reach(const Matrix6d& q) const {
  if (q.diagonal().maxCoeff() <= kLittleNoise) return q;
  const SE3d position(SO3d(), joint.pose(kCamera).translation());
  return within_reach(q, position.inverse().adjoint_congruence(joint.covariance(kCamera, kCamera)));
}

void MultiObjectState::predict_with_odometry(const SE3d& change, const Matrix6d& q, double dt) {
  const KeptVector<OtherMomentsList> others = moments_of_others();
  const SE3d before = joint.pose(kCamera);
  const SE3d camera = before * change;
  joint.set_pose(kCamera, camera);
  joint.add_noise(kCamera, camera.adjoint_congruence(within_reach(q)));
  if (rig_motion) rig_motion->is_told = true;
  if (joint.is_linearised()) {
    const SE3d at = joint.linearised_at();
    joint.linearise_at(at * rig_motion->odometry.take(change, q));
    add_noise_of_extrinsics(joint.linearised_at().adjoint() - at.adjoint() -
                            (camera.adjoint() - before.adjoint()));
  }
  advance(dt, before, others);
}

void MultiObjectState::add_noise_of_extrinsics(const Matrix6d& map) {
  for (std::size_t e = 0; e < joint.extrinsics(); ++e) {
    const std::size_t block = JointGaussian::extrinsic_block(e);
    const Matrix6d covariance = joint.covariance(block, block);
    joint.add_noise(kCamera, map * covariance * map.transpose());
  }
}

void MultiObjectState::predict_random_walk(const Matrix6d& given, double dt) {
  const Matrix6d q = within_reach(given);
  if (rig_motion) rig_motion->is_told = false;
  KeptVector<OtherMomentsList> others = moments_of_others();
  if (!lose_camera(q, others)) joint.add_noise(kCamera, joint.pose(kCamera).adjoint_congruence(q));
  advance(dt, std::nullopt, others);
}

/// Rotation about the camera and its position are independent then: only the position's covariance
/// is that of before with that of the noise, both seen from where the camera is, so that none of it
/// is a difference of what a wide rotation has about the origin.
bool MultiObjectState::lose_camera(const Matrix6d& q, KeptVector<OtherMomentsList>& others) {
  // Half of what there is to know: it is the camera's again, and has an end.
  if (world_error.topLeftCorner<3, 3>().diagonal().maxCoeff() > 0.5 * kUniformRotationVariance)
    take_in_world_error();
  const SE3d& camera = joint.pose(kCamera);
  const Matrix6d before = joint.covariance(kCamera, kCamera);
  const Matrix6d after = before + camera.adjoint_congruence(q);
  if (after.topLeftCorner<3, 3>().diagonal().maxCoeff() <= kUniformRotationVariance) return false;
  const SE3d position(SO3d(), camera.translation());
  const SE3d turn(camera.rotation(), Eigen::Vector3d::Zero());
  const Matrix6d near = position.inverse().adjoint_congruence(before) + turn.adjoint_congruence(q);
  Matrix6d there = Matrix6d::Zero();
  there.topLeftCorner<3, 3>().diagonal().setConstant(kUniformRotationVariance);
  there.bottomRightCorner<3, 3>() = near.bottomRightCorner<3, 3>();
  others = moments_of_others(true);
  joint.release_camera(position.adjoint_congruence(there));
  for (TrackedObject& object : objects) object.belief.release_camera();
  return true;
}

void MultiObjectState::predict_constant_velocity(double periods, const Matrix6d& q,
                                                 const Matrix6d& q_motion, const Matrix6d& at_rest,
                                                 double dt) {
  const KeptVector<OtherMomentsList> others = moments_of_others();
  if (rig_motion) rig_motion->is_told = false;
  if (!motion) motion = joint.append_motion(SE3d(), at_rest);
  const std::size_t at = *motion;
  const SE3d camera = joint.pose(kCamera);
  const SE3d velocity = joint.pose(at);
  const Matrix6d transfer = constant_velocity_transfer(camera, velocity, periods);

  // xi_C <- xi_C + F xi_V. First the alternatives, whose poses depend on the camera alone: P_OC
  // grows by P_OC P_CC^-1 P_CV F^T. Then the joint Gaussian.
  // With extrinsics it grows by the regression on camera and extrinsics.
  const Eigen::LLT<Matrix6d> before(joint.covariance(kCamera, kCamera));
  KeptMatrix<6> with_motion(joint.rig().rows());
  if (joint.extrinsics() == 0) {
    with_motion.get() =
        Matrix6d(before.solve(joint.covariance(kCamera, at)) * transfer.transpose());
  } else {
    Eigen::MatrixXd columns(joint.rig().rows(), 6);
    for (std::size_t i = 0; i <= joint.extrinsics(); ++i)
      rows(columns, i) = joint.covariance(i, at);
    with_motion.get() = joint.rig().llt().solve(columns) * transfer.transpose();
  }
  for (TrackedObject& object : objects) object.belief.add_to_cross_covariances(with_motion.get());
  joint.combine({kCamera, Matrix6d::Identity(), at, transfer});
  const SE3d moved = camera * SE3d::exp(periods * velocity.log());
  joint.set_pose(kCamera, moved);
  joint.add_noise(kCamera, moved.adjoint_congruence(within_reach(q)));
  joint.add_noise(at, velocity.adjoint_congruence(q_motion));
  joint.make_symmetric();
  advance(dt, std::nullopt, others);
}

/// The prediction with F = 0: nothing of the camera before is a part of the one after.
void MultiObjectState::set_camera(const ConcentratedGaussian<SE3d>& world_camera, double dt) {
  take_in_world_error();
  const KeptVector<OtherMomentsList> others = moments_of_others(true);
  const SE3d before = joint.pose(kCamera);
  const SE3d position(SO3d(), world_camera.mean().translation());
  const Matrix6d here = position.inverse().adjoint_congruence(world_camera.covariance());
  const Matrix6d less = within_reach(here, Matrix6d::Zero());
  joint.set_pose(kCamera, world_camera.mean());
  joint.release_camera(less == here ? world_camera.covariance()
                                    : position.adjoint_congruence(less));
  for (TrackedObject& object : objects) object.belief.release_camera();
  camera_given_at = update_count;
  if (rig_motion) {
    rig_motion->is_told = true;
    const SE3d& body = world_camera.mean();
    const SE3d& at = rig_motion->given.follow(
        body, body.inverse().adjoint_congruence(world_camera.covariance()));
    if (joint.is_linearised()) {
      joint.linearise_at(at);
      add_noise_of_extrinsics(at.adjoint() - body.adjoint());
    }
  }
  advance(dt, before, others);
}

}  // namespace posemix::internal
