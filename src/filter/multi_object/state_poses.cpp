// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "camera_regression.hpp"
#include "multi_object_state.hpp"

/// How all poses move by a detection.
namespace posemix::internal {

/// The camera and the leading hypotheses move by eq. (5) to (8), and every other hypothesis follows
/// the camera by eq. (9).
void MultiObjectState::move_poses(TrackedObject& object, const ObservedDetection& observed,
                                  bool damped, double log_evidence, Alternatives& births) {
  const DetectionUpdates& updates = observed.updates;
  ObjectBelief& belief = object.belief;
  const Explanation& leading = updates[*belief.leading()].explanation;
  const CameraMoments before = joint.camera_moments();
  const ObservationSource& source = observed.observation.source;
  const SE3d body = joint.pose(kCamera);
  Transport transport(joint, *belief.pose_index(), source,
                      belief.state_from(joint, *belief.leading(), source), leading.inlier(),
                      poses_beside_joint(births), observed.factors.are_whole);
  const CameraAlternative alternative =
      belief.camera_alternative(updates, births, log_evidence, before);
  const CameraChange change =
      joint.update(*belief.pose_index(), leading, alternative, observed.factors, source);
  CameraMoments after = joint.camera_moments();
  after.mean = change.mean;
  after.rig.mean = change.rig_mean;
  belief.follow_camera(updates, after);
  const CameraRegression step(before, after);
  for (TrackedObject& other : objects) {
    if (&other != &object) other.belief.follow_camera(step);
  }
  for (Alternative& birth : births) step.carry(birth.pose);
  transport.follow();
  shift_back(object, damped, change, births);
  if (source.camera) rig_motion->correct(body, joint.pose(kCamera), leading.inlier().noise);
  transport.apply(!rig_motion || !rig_motion->is_seen_exactly);
}

/// Those of the hypotheses that do not lead, and of births.
KeptVector<ConditionalPose*> MultiObjectState::poses_beside_joint(Alternatives& births) {
  KeptVector<ConditionalPose*> poses;
  for (TrackedObject& object : objects) object.belief.append_alternatives(poses);
  for (Alternative& birth : births) poses.push_back(&birth.pose);
  return poses;
}

/// Eq. (10): a shift of the world takes a part of the camera's correction back, so that all poses
/// relative to each other stay as they are.
void MultiObjectState::shift_back(const TrackedObject& detected, bool damped,
                                  const CameraChange& change, Alternatives& births) {
  Vector6d taken;
  taken.head<3>().setConstant(1.0 - settings.camera_rotation_correction);
  taken.tail<3>().setConstant(1.0 - settings.camera_position_correction);
  if (!damped || taken.isZero(0.0)) return;
  const SE3d& at = joint.pose(kCamera);
  const Matrix6d back = at.adjoint() * taken.asDiagonal() * at.inverse().adjoint();
  const CameraMoments camera = joint.camera_moments();
  joint.shift_back(change, back);
  for (TrackedObject& object : objects)
    object.belief.shift_back(change, back, camera, &object == &detected);
  for (Alternative& birth : births) internal::shift_back(birth.pose, change, back, camera);
}

}  // namespace posemix::internal
