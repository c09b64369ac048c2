// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "object_belief.hpp"
#include "posemix/filter/update.hpp"

/// How hypotheses that do not lead follow the camera, eq. (9) and (10) of docs/many-objects.md.
namespace posemix::internal {
namespace {

/// The same given camera and extrinsics.
bool is_positive_definite_given_rig(const ConditionalPose& object, const Eigen::MatrixXd& rig) {
  const Eigen::MatrixXd g = regression_on_rig(object, rig);
  const Matrix12d given = object.covariance - g * rig * g.transpose();
  const Matrix6d pose = given.topLeftCorner<6, 6>();
  return Eigen::LLT<Matrix6d>(pose).info() == Eigen::Success &&
         (!object.slow || Eigen::LLT<Matrix12d>(given).info() == Eigen::Success);
}

/// Covariance of camera and extrinsics after a shift of the world.
Eigen::MatrixXd shifted_rig(Eigen::MatrixXd rig, const CameraChange& change, const Matrix6d& back) {
  const SixColumns with_error =
      change.error_covariance.get().topRows(rig.rows()) * back.transpose();
  rig.leftCols<6>() += with_error;
  rig.topRows<6>() += with_error.transpose();
  rig.topLeftCorner<6, 6>() += back * change.covariance * back.transpose();
  return rig;
}

/// Whether the pose has a positive definite covariance given the camera.
bool is_positive_definite_given(const ConditionalPose& object, const Matrix6d& camera) {
  const Matrix12x6d g = regression_on_camera(object.cross_covariance, camera);
  const Matrix12d given = object.covariance - g * object.cross_covariance.transpose();
  const Matrix6d pose = given.topLeftCorner<6, 6>();
  return Eigen::LLT<Matrix6d>(pose).info() == Eigen::Success &&
         (!object.slow || Eigen::LLT<Matrix12d>(given).info() == Eigen::Success);
}

}  // namespace

void shift_back(ConditionalPose& pose, const CameraChange& change, const Matrix6d& back,
                const Matrix12x6d& follows) {
  const Matrix6d with_error = change.error_covariance.get().topRows<6>() * back.transpose();
  const Matrix12x6d x = follows * with_error;
  const Matrix6d added = back * change.covariance * back.transpose();
  pose.pose = SE3d::exp(-back * change.mean) * pose.pose;
  pose.covariance.leftCols<6>() += x;
  pose.covariance.topRows<6>() += x.transpose();
  pose.covariance.topLeftCorner<6, 6>() += added;
  pose.cross_covariance += x;
  pose.cross_covariance.topRows<6>() += with_error.transpose() + added;
}

/// Extrinsics are poses on the body, which a shift of the world leaves as they are.
void shift_back_with_rig(ConditionalPose& pose, const CameraChange& change, const Matrix6d& back,
                         const Eigen::MatrixXd& follows) {
  const Eigen::Index extrinsics = follows.cols() - 6;
  shift_back(pose, change, back, Matrix12x6d::Zero());
  const SixColumns with_error =
      change.error_covariance.get().topRows(follows.cols()) * back.transpose();
  const Matrix12x6d x = follows * with_error;
  pose.covariance.leftCols<6>() += x;
  pose.covariance.topRows<6>() += x.transpose();
  pose.cross_covariance += x;
  pose.extrinsics.topRows<6>() += with_error.bottomRows(extrinsics).transpose();
}

void shift_back(ConditionalPose& pose, const CameraChange& change, const Matrix6d& back,
                const CameraMoments& camera) {
  if (camera.rig.empty()) {
    shift_back(pose, change, back, regression_on_camera(pose.cross_covariance, camera.covariance));
  } else {
    shift_back_with_rig(pose, change, back, regression_on_rig(pose, camera.rig.covariance));
  }
}

void ObjectBelief::follow_camera(const DetectionUpdates& updates, const CameraMoments& after) {
  for (std::size_t i = 0; i < alternatives_.size(); ++i) {
    const DetectionMoments& own = updates[index_of(i)].posterior;
    ConditionalPose& object = alternatives_[i].pose;
    move(object, own.mean.tail<12>());
    object.covariance = own.covariance.bottomRightCorner<12, 12>();
    object.cross_covariance = own.covariance.bottomLeftCorner<12, 6>();
    object.extrinsics = updates[index_of(i)].extrinsics();
    const CameraMoments before = updates[index_of(i)].camera();
    CameraRegression(before, after).carry(object);
  }
}

void ObjectBelief::follow_camera(const CameraRegression& step) {
  for (Alternative& alternative : alternatives_) step.carry(alternative.pose);
}

void ObjectBelief::shift_back(const CameraChange& change, const Matrix6d& back,
                              const CameraMoments& camera, bool detected) {
  if (alternatives_.empty()) return;
  const Eigen::MatrixXd& rig = camera.rig.covariance;
  const Eigen::MatrixXd rig_after =
      camera.rig.empty() ? Eigen::MatrixXd() : shifted_rig(rig, change, back);
  const Cholesky6 factor(camera.covariance);
  const Matrix6d with_error = change.error_covariance.get().topRows<6>() * back.transpose();
  const Matrix6d shifted =
      with_error + with_error.transpose() + back * change.covariance * back.transpose();
  for (Alternative& alternative : alternatives_) {
    ConditionalPose& pose = alternative.pose;
    if (detected) {
      // The correction is that of the leading hypothesis, and the covariance of this one need not
      // be positive definite with it.
      ConditionalPose own = pose;
      if (camera.rig.empty()) {
        internal::shift_back(own, change, back, Matrix12x6d::Zero());
      } else {
        shift_back_with_rig(own, change, back, Eigen::MatrixXd::Zero(12, rig.cols()));
      }
      if (camera.rig.empty() ? is_positive_definite_given(own, camera.covariance + shifted)
                             : is_positive_definite_given_rig(own, rig_after)) {
        pose = own;
        continue;
      }
    }
    if (camera.rig.empty()) {
      internal::shift_back(pose, change, back, factor.solved_rows(pose.cross_covariance));
    } else {
      shift_back_with_rig(pose, change, back, regression_on_rig(pose, rig));
    }
  }
}

}  // namespace posemix::internal
