// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detector/view_turn.hpp"
#include "object_belief.hpp"

namespace posemix::internal {

Eigen::Vector3d ObjectBelief::decay_slow_error(JointGaussian& joint, const SlowError& slow,
                                               const Matrix6d& stationary,
                                               const std::optional<SE3d>& camera_before, double dt,
                                               const OtherMomentsList& others) {
  // b <- a b + w with a = exp(-|view angle| / theta - dt / tau) and Cov w = (1 - a^2) B.
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  const std::optional<OtherMoments>* before_motion = others.data();
  for (std::size_t h = 0; h < size(); ++h) {
    Standing& standing = mutable_standing(h);
    const SE3d& object = mean(joint, h);
    const SE3d now = joint.pose(kCamera).inverse() * object;
    const SE3d before =
        camera_before ? camera_before->inverse() * object : standing.seen_from.value_or(now);
    standing.seen_from = now;
    const Eigen::Vector3d turned = view_turn(before, now);
    const double a = slow.correlation(dt, turned.norm());
    const Matrix6d q = (1.0 - a * a) * stationary;
    decay_other_cameras(joint, h, slow, a, stationary, before_motion);
    before_motion += standing.others.size();
    if (leads(h)) {
      joint.decay_slow(leader_->pose_index, a, q);
      turn = turned;
      continue;
    }
    ConditionalPose& other = alternatives_[slot(h)].pose;
    *other.slow *= a;
    other.covariance.bottomRows<6>() *= a;
    other.covariance.rightCols<6>() *= a;
    other.covariance.bottomRightCorner<6, 6>() += q;
    other.cross_covariance.bottomRows<6>() *= a;
    other.extrinsics.bottomRows<6>() *= a;
  }
  return turn;
}

void ObjectBelief::transform(JointGaussian& joint, std::size_t h, const Matrix12d& f) {
  if (leads(h)) {
    const Eigen::Index n = offset(joint.blocks_of(leader_->pose_index));
    joint.transform(leader_->pose_index, f.topLeftCorner(n, n));
    return;
  }
  ConditionalPose& other = alternatives_[slot(h)].pose;
  other.covariance = (f * other.covariance * f.transpose()).eval();
  symmetrize(other.covariance);
  other.cross_covariance = (f * other.cross_covariance).eval();
  if (other.extrinsics.cols() > 0) other.extrinsics = (f * other.extrinsics).eval();
}

void ObjectBelief::rescale_slow_error(JointGaussian& joint, const ObjectSensor& sensor,
                                      const Vector6d& factor) {
  for (std::size_t h = 0; h < size(); ++h) {
    const DetectionState before = state(joint, h);
    const Matrix6d a = slow_error_map(before, sensor.noise.components().front(), sensor);
    Matrix12d f = Matrix12d::Identity();
    f.topRightCorner<6, 6>() = a * (Vector6d::Ones() - factor).asDiagonal();
    f.bottomRightCorner<6, 6>() = factor.asDiagonal();
    transform(joint, h, f);
    Vector12d by;
    by.tail<6>() = (factor - Vector6d::Ones()).cwiseProduct(before.slow);
    by.head<6>() = -a * by.tail<6>();
    if (leads(h)) {
      joint.move_object(leader_->pose_index, by);
    } else {
      move(alternatives_[slot(h)].pose, by);
    }
    for (OtherCamera& other : mutable_standing(h).others) {
      other.follow(before.camera, before.object, before.slow);
      rescale(other, factor, SE3d(SO3d(), -before.object.translation()).adjoint() * a);
      other.body_object = before.camera.inverse() * mean(joint, h);
    }
  }
}

void ObjectBelief::approach_camera(JointGaussian& joint, std::size_t h, const Matrix6d& f) {
  const Matrix6d own = Matrix6d::Identity() - f;
  if (leads(h)) {
    joint.activate(leader_->pose_index);
    joint.combine({leader_->pose_index, own, kCamera, f});
    return;
  }
  ConditionalPose& other = alternatives_[slot(h)].pose;
  const auto rig = joint.rig();
  const Matrix6d camera = rig.topLeftCorner<6, 6>();
  Matrix12d a = Matrix12d::Identity();
  a.topLeftCorner<6, 6>() = own;
  Matrix12d with_camera = Matrix12d::Zero();
  with_camera.leftCols<6>() = a * other.cross_covariance * f.transpose();
  other.covariance = a * other.covariance * a.transpose() + with_camera + with_camera.transpose();
  other.covariance.topLeftCorner<6, 6>() += f * camera * f.transpose();
  symmetrize(other.covariance);
  other.cross_covariance = (a * other.cross_covariance).eval();
  other.cross_covariance.topRows<6>() += f * camera;
  if (other.extrinsics.cols() == 0) return;
  other.extrinsics.topRows<6>() = (own * other.extrinsics.topRows<6>()).eval();
  other.extrinsics.topRows<6>() += f * rig.topRows<6>().rightCols(rig.cols() - 6);
}

void ObjectBelief::add_noise(JointGaussian& joint, std::size_t h, const Matrix6d& q) {
  if (leads(h)) {
    joint.add_noise(leader_->pose_index, q);
  } else {
    alternatives_[slot(h)].pose.covariance.topLeftCorner<6, 6>() += q;
  }
}

void ObjectBelief::fix_unobserved(JointGaussian& joint, const SymmetryGroup& symmetries) {
  if (symmetries.axes().empty()) return;
  // Along the object's axes: P <- F P F^T + v U, where F takes the rotations about the axes away
  // and U is the covariance of a uniform angle.
  for (std::size_t h = 0; h < size(); ++h) {
    const SE3d object = mean(joint, h);
    Matrix12d all = Matrix12d::Identity();
    all.topLeftCorner<6, 6>() =
        object.adjoint() * symmetries.observed_projection() * object.inverse().adjoint();
    transform(joint, h, all);
    add_noise(joint, h,
              kFixedAngle * object.adjoint_congruence(symmetries.unobserved_covariance()));
  }
}

void ObjectBelief::fix_unobserved_beside_camera(JointGaussian& joint, const ObjectSensor& sensor) {
  const SymmetryGroup& symmetries = sensor.symmetries;
  if (symmetries.axes().empty()) return;
  const NoiseComponent& inlier = sensor.noise.components().front();
  for (std::size_t h = 0; h < size(); ++h) {
    const DetectionState at = state(joint, h);
    const NoiseAtPose noise = noise_at(inlier, at.camera_object());
    const Matrix6d common =
        at.common_part((at.camera * noise.axes).adjoint_congruence(noise.covariance));
    const Matrix6d observed =
        at.object.adjoint() * symmetries.observed_projection() * at.object.inverse().adjoint();
    const Matrix6d f = (Matrix6d::Identity() - observed) * common;
    const Matrix6d fixed =
        kFixedAngle * at.object.adjoint_congruence(symmetries.unobserved_covariance());
    approach_camera(joint, h, f);
    add_noise(joint, h, f * fixed * f.transpose());
  }
}

void ObjectBelief::release_camera() {
  for (Alternative& alternative : alternatives_) alternative.pose.cross_covariance.setZero();
}

void ObjectBelief::add_to_cross_covariances(const Eigen::Ref<const SixColumns>& factor) {
  const Matrix6d of_camera = factor.topRows<6>();
  for (Alternative& alternative : alternatives_) {
    Matrix12x6d change = alternative.pose.cross_covariance * of_camera;
    if (factor.rows() > 6)
      change += alternative.pose.extrinsics * factor.bottomRows(factor.rows() - 6);
    alternative.pose.cross_covariance += change;
  }
}

}  // namespace posemix::internal
