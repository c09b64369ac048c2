// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <utility>

#include "object_belief.hpp"

/// Cameras of a rig whose poses on the body are a part of the state (docs/many-objects.md, "Cameras
/// of a rig").
namespace posemix::internal {

CameraMoments DetectionUpdate::camera() const {
  CameraMoments moments{posterior.mean.head<6>(), posterior.covariance.topLeftCorner<6, 6>()};
  if (with_extrinsics.empty()) return moments;
  const Eigen::Index n = with_extrinsics.mean.size() - 12;
  moments.rig = {with_extrinsics.mean.head(n), with_extrinsics.covariance.topLeftCorner(n, n)};
  return moments;
}

Eigen::Matrix<double, 12, Eigen::Dynamic> DetectionUpdate::extrinsics() const {
  if (with_extrinsics.empty()) return {};
  return with_extrinsics.covariance.bottomRows<12>().middleCols(
      6, with_extrinsics.covariance.cols() - 18);
}

DetectionUpdate observe(const DetectionState& state, const Eigen::MatrixXd& seen_by,
                        const Eigen::MatrixXd& covariance, const WeighedObservation& observation,
                        const ObjectSensor& sensor, const GainFactors& factors) {
  Explanation explanation = explain(state, observation, sensor);
  linearise_there(state, observation, sensor, explanation);
  return moved_by(std::move(explanation), seen_by, covariance, factors);
}

DetectionUpdate moved_by(Explanation explanation, const Eigen::MatrixXd& seen_by,
                         const Eigen::MatrixXd& covariance, const GainFactors& factors) {
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, 6>;
  const Eigen::Index n = covariance.rows();
  const Eigen::Index rig = n - 12;
  DetectionUpdate result{std::move(explanation), {}, {Eigen::VectorXd::Zero(n), covariance}};
  RigMoments& all = result.with_extrinsics;
  if (std::isfinite(result.log_evidence())) {
    Eigen::VectorXd gain = Eigen::VectorXd::Constant(n, factors.camera);
    gain.segment<6>(rig).setOnes();
    gain.tail<6>().setConstant(factors.slow);
    const Columns without_slow =
        covariance.middleCols<6>(rig) - Columns(covariance.leftCols(rig) * seen_by.transpose());
    GaussianUpdate update(gain, all.mean, all.covariance);
    for (const Innovation& seen : result.explanation.innovations) {
      if (!(seen.weight > 0.0)) continue;
      const Columns d = without_slow + covariance.rightCols<6>() * seen.slow_map.transpose();
      update.add(seen, d);
    }
    update.finish();
  }
  DetectionMoments& posterior = result.posterior;
  posterior.mean << all.mean.head<6>(), all.mean.tail<12>();
  posterior.covariance << all.covariance.topLeftCorner<6, 6>(),
      all.covariance.topRightCorner<6, 12>(), all.covariance.bottomLeftCorner<12, 6>(),
      all.covariance.bottomRightCorner<12, 12>();
  return result;
}

Eigen::MatrixXd regression_on_rig(const ConditionalPose& object, const Eigen::MatrixXd& rig) {
  Eigen::MatrixXd cross = Eigen::MatrixXd::Zero(12, rig.cols());
  cross.leftCols<6>() = object.cross_covariance;
  cross.middleCols(6, object.extrinsics.cols()) = object.extrinsics;
  return rig.llt().solve(cross.transpose()).transpose();
}

void JointGaussian::append_extrinsic(const ConcentratedGaussian<SE3d>& body_camera) {
  require(size() == 1 + extrinsics_, "an extrinsic is appended behind others alone");
  append_motion(body_camera.mean(), body_camera.covariance());
  blocks_.back().is_motion = false;
  ++extrinsics_;
}

SE3d JointGaussian::seeing_camera(const ObservationSource& source) const {
  return pose(kCamera) *
         (source.camera ? pose(extrinsic_block(*source.camera)) : source.body_camera);
}

/// T_world_body Exp(xi_E) T_body_camera = Exp(Ad xi_E) T_world_body T_body_camera, with Ad where
/// the body is known to have moved to.
Eigen::MatrixXd JointGaussian::seen_by(const ObservationSource& source) const {
  Eigen::MatrixXd map = Eigen::MatrixXd::Identity(6, rig_dof());
  if (source.camera)
    map.middleCols<6>(offset(extrinsic_block(*source.camera))) = linearised_at().adjoint();
  return map;
}

CameraMoments JointGaussian::camera_moments(const JointGaussian& at) const {
  CameraMoments moments{Vector6d::Zero(), covariance(kCamera, kCamera)};
  const auto apart = [&](std::size_t index) -> Vector6d {
    return &at == this ? Vector6d(Vector6d::Zero())
                       : Vector6d((pose(index) * at.pose(index).inverse()).log());
  };
  moments.mean = apart(kCamera);
  if (extrinsics_ == 0) return moments;
  moments.rig = {Eigen::VectorXd(rig_dof()), rig()};
  for (std::size_t i = 0; i <= extrinsics_; ++i) moments.rig.mean.segment<6>(offset(i)) = apart(i);
  return moments;
}

DetectionState ObjectBelief::state_from(const JointGaussian& joint, std::size_t h,
                                        const ObservationSource& source) const {
  DetectionState state = this->state(joint, h);
  state.camera = joint.seeing_camera(source);
  if (!source.camera) return state;
  const ConditionalPose object = pose(joint, h);
  const Eigen::MatrixXd by = joint.seen_by(source);
  const Matrix6d own = by * joint.rig() * by.transpose();
  const Matrix12x6d cross = object.cross_covariance * by.leftCols<6>().transpose() +
                            object.extrinsics * by.rightCols(by.cols() - 6).transpose();
  state.covariance.topLeftCorner<6, 6>() = own;
  state.covariance.bottomLeftCorner<12, 6>() = cross;
  state.covariance.topRightCorner<6, 12>() = cross.transpose();
  return state;
}

}  // namespace posemix::internal
