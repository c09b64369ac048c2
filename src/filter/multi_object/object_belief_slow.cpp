// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include "object_belief.hpp"

/// The slow errors of an object's detector, by camera: eq. (39) to (42) of docs/many-objects.md.
namespace posemix::internal {
namespace {

/// Of a camera that is moved on its body, and has another pose there with every detection, the
/// oldest ones are forgotten.
constexpr std::size_t kMostOthers = 8;

/// The correlation of the slow errors of two cameras that see an object at once.
double correlation_of(const SlowError& slow, const JointGaussian& joint, const SE3d& object,
                      const ObservationSource& a, const ObservationSource& b) {
  return slow.correlation(0.0, view_angle(joint.seeing_camera(a).inverse() * object,
                                          joint.seeing_camera(b).inverse() * object));
}

/// b <- L_e (xi_O - by [xi_C; xi_E ...]) + L_b b + n, for a hypothesis that does not lead.
void apply(const OtherCamera& next, const SeenByRig& seen, const Eigen::MatrixXd& by,
           const Eigen::MatrixXd& rig, ConditionalPose& pose) {
  const Matrix6d on_error = next.on_error() * seen.to_place();
  const Eigen::Index extrinsics = pose.extrinsics.cols();
  Eigen::Matrix<double, 12, Eigen::Dynamic> cross(12, 6 + extrinsics);
  cross.leftCols<6>() = pose.cross_covariance;
  cross.rightCols(extrinsics) = pose.extrinsics;
  Matrix12d pair;
  pair << seen.errors(next.source, next.source), seen.slow_and_error(next.source).transpose(),
      seen.slow_and_error(next.source), seen.slow();
  const Matrix6d with_object =
      on_error * (pose.covariance.topLeftCorner<6, 6>() - by * cross.topRows<6>().transpose()) +
      next.on_seeing() * pose.covariance.bottomLeftCorner<6, 6>();
  cross.bottomRows<6>() =
      (on_error * (cross.topRows<6>() - by * rig) + next.on_seeing() * cross.bottomRows<6>())
          .eval();
  pose.covariance.bottomLeftCorner<6, 6>() = with_object;
  pose.covariance.topRightCorner<6, 6>() = with_object.transpose();
  pose.covariance.bottomRightCorner<6, 6>() =
      next.given * pair * next.given.transpose() + next.covariance;
  symmetrize(pose.covariance);
  pose.cross_covariance = cross.leftCols<6>();
  if (extrinsics > 0) pose.extrinsics = cross.rightCols(extrinsics);
  pose.slow = next.mean;
}

}  // namespace

OtherCamera ObjectBelief::seen_next(const JointGaussian& joint, std::size_t h,
                                    const ObservationSource& last, const ObservationSource& source,
                                    const ObjectSensor& sensor) const {
  const SE3d& body = joint.pose(kCamera);
  const ConditionalPose own = pose(joint, h);
  const Matrix6d stationary = *sensor.slow_covariance();
  const auto& others = standing(h).others;
  const auto known = std::find_if(others.begin(), others.end(), [&](const OtherCamera& other) {
    return is_same_camera(other.source, source);
  });
  if (known != others.end()) {
    OtherCamera next = *known;
    next.follow(body, own.pose, *own.slow);
    if (is_known(next, SeenByRig(joint, own), stationary)) return next;
  }
  OtherCamera next = other_camera(
      source, correlation_of(*sensor.noise.dependence().slow, joint, own.pose, last, source),
      stationary);
  next.body = body;
  next.body_object = body.inverse() * own.pose;
  next.follow(body, own.pose, *own.slow);
  return next;
}

CameraSlowError ObjectBelief::slow_error_of(const JointGaussian& joint, std::size_t h,
                                            const ObservationSource& source,
                                            const ObservationSource& first,
                                            const ObjectSensor& sensor) const {
  if (is_same_camera(seen_by_.value_or(first), source))
    return {.mean = pose(joint, h).slow.value()};
  const OtherCamera other = seen_next(joint, h, seen_by_.value_or(first), source, sensor);
  return {.mean = other.mean,
          .on_object = other.on_error() * SE3d(SO3d(), -mean(joint, h).translation()).adjoint(),
          .on_seeing = other.on_seeing(),
          .covariance = other.covariance};
}

DetectionState ObjectBelief::state_seen_from(const JointGaussian& joint, std::size_t h,
                                             const ObservationSource& source,
                                             const ObjectSensor& sensor) const {
  DetectionState state = state_from(joint, h, source);
  if (!state.has_slow || !seen_by_ || is_same_camera(*seen_by_, source)) return state;
  const OtherCamera next = seen_next(joint, h, *seen_by_, source, sensor);
  const Matrix6d on_error = next.on_error() * SE3d(SO3d(), -state.object.translation()).adjoint();
  Eigen::Matrix<double, 6, 18> l;
  l << -on_error, on_error, next.on_seeing();
  const Eigen::Matrix<double, 6, 18> with_all = l * state.covariance;
  const Matrix6d own = with_all * l.transpose() + next.covariance;
  state.covariance.bottomRows<6>() = with_all;
  state.covariance.rightCols<6>() = with_all.transpose();
  state.covariance.bottomRightCorner<6, 6>() = own;
  symmetrize(state.covariance);
  state.slow = next.mean;
  return state;
}

void ObjectBelief::see_from(JointGaussian& joint, const ObservationSource& source,
                            const ObjectSensor& sensor) {
  if (!sensor.noise.dependence().slow) return;
  if (seen_by_ && !is_same_camera(*seen_by_, source)) {
    for (std::size_t h = 0; h < size(); ++h) see_from(joint, h, source, sensor);
  }
  seen_by_ = source;
  for (std::size_t h = 0; h < size(); ++h)
    for (OtherCamera& other : mutable_standing(h).others) other.is_followed = true;
}

void ObjectBelief::see_from(JointGaussian& joint, std::size_t h, const ObservationSource& source,
                            const ObjectSensor& sensor) {
  const OtherCamera next = seen_next(joint, h, *seen_by_, source, sensor);
  const ConditionalPose before = pose(joint, h);
  const SeenByRig seen(joint, before);
  std::vector<OtherCamera>& others = mutable_standing(h).others;
  std::erase_if(others,
                [&](const OtherCamera& other) { return is_same_camera(other.source, source); });
  if (others.size() >= kMostOthers) others.erase(others.begin());
  for (OtherCamera& other : others) other.follow(joint.pose(kCamera), before.pose, *before.slow);
  take_turns(others, next, *seen_by_, seen);

  const Eigen::MatrixXd by = joint.seen_by(source);
  if (!leads(h)) {
    apply(next, seen, by, joint.rig(), alternatives_[slot(h)].pose);
    return;
  }
  const std::size_t index = leader_->pose_index;
  const std::size_t slow = index + 1;
  const Matrix6d on_error = next.on_error() * seen.to_place();
  joint.activate(index);
  joint.combine({slow, next.on_seeing(), index, on_error});
  const auto follow = [&](std::size_t block) {
    const Matrix6d part = -on_error * by.middleCols<6>(offset(block));
    joint.combine({slow, Matrix6d::Identity(), block, part});
  };
  follow(kCamera);
  if (source.camera) follow(JointGaussian::extrinsic_block(*source.camera));
  joint.decay_slow(index, 1.0, next.covariance);
  Vector12d moved = Vector12d::Zero();
  moved.tail<6>() = next.mean - *before.slow;
  joint.move_object(index, moved);
}

OtherMomentsList ObjectBelief::moments_of_others(const JointGaussian& joint, bool released) {
  OtherMomentsList moments;
  for (std::size_t h = 0; h < size(); ++h) {
    std::vector<OtherCamera>& others = mutable_standing(h).others;
    if (others.empty()) continue;
    const SE3d& object = mean(joint, h);
    const Vector6d& slow =
        leads(h) ? joint.slow(leader_->pose_index + 1) : alternatives_[slot(h)].pose.slow.value();
    for (OtherCamera& other : others) other.follow(joint.pose(kCamera), object, slow);
    if (!others.front().is_followed) {
      moments.resize(moments.size() + others.size());
      continue;
    }
    const ConditionalPose before = pose(joint, h);
    const SeenByRig seen(joint, before);
    for (const OtherCamera& other : others)
      moments.emplace_back(moments_before(other, seen, released));
  }
  return moments;
}

void ObjectBelief::decay_other_cameras(const JointGaussian& joint, std::size_t h,
                                       const SlowError& slow, double a, const Matrix6d& stationary,
                                       const std::optional<OtherMoments>* before) {
  std::vector<OtherCamera>& others = mutable_standing(h).others;
  if (others.empty()) return;
  const SE3d& object = mean(joint, h);
  std::optional<ConditionalPose> after;
  if (*before) after = pose(joint, h);
  for (OtherCamera& other : others) {
    if (*before) {
      decay(other, **before, SeenByRig(joint, *after), a,
            correlation_of(slow, joint, object, *seen_by_, other.source), stationary);
    } else {
      decay(other, a, stationary);
    }
    other.body = joint.pose(kCamera);
    other.body_object = joint.pose(kCamera).inverse() * object;
    other.is_followed = false;
    ++before;
  }
}

}  // namespace posemix::internal
