// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detection_update.hpp"

#include <cmath>
#include <utility>

namespace posemix::internal {

/// P H^T with H = [-I I A].
Matrix18x6d times_ht(const Matrix18d& p, const Matrix6d& slow_map) {
  Matrix18x6d d = p.middleCols<6>(kObjectRow) - p.middleCols<6>(kCameraRow);
  d.noalias() += p.middleCols<6>(kSlowRow) * slow_map.transpose();
  return d;
}

std::optional<double> DetectionUpdate::nis() const {
  const Innovation& inlier = explanation.inlier();
  const Cholesky6 s(inlier.covariance);
  if (!s.ok()) return std::nullopt;
  return s.whitened(inlier.residual).squaredNorm();
}

Vector6d DetectionUpdate::white_residual() const {
  const Innovation& inlier = explanation.inlier();
  const SE3d to_axes = inlier.axes.inverse();
  const Vector6d residual = to_axes.adjoint_blocks().times(inlier.residual);
  return residual.cwiseQuotient(
      to_axes.adjoint_congruence(inlier.covariance).diagonal().cwiseSqrt());
}

namespace {

/// The update of camera and object, which have no slow error.
void move_pair(const DetectionState& state, double camera_gain, DetectionUpdate& update) {
  using Vector12d = Eigen::Matrix<double, 12, 1>;
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  const Matrix12d before = state.covariance.topLeftCorner<12, 12>();
  const Eigen::Matrix<double, 12, 6> d =
      before.middleCols<6>(kObjectRow) - before.middleCols<6>(kCameraRow);
  Vector12d gain = Vector12d::Ones();
  gain.head<6>().setConstant(camera_gain);
  Vector12d mean;
  Matrix12d covariance = before;
  GaussianUpdate pair(gain, mean, covariance);
  for (const Innovation& seen : update.explanation.innovations) {
    if (seen.weight > 0.0) pair.add(seen, d);
  }
  pair.finish();
  update.posterior.mean.head<12>() = mean;
  update.posterior.covariance.topLeftCorner<12, 12>() = covariance;
}

}  // namespace

DetectionUpdate moved_by(Explanation explanation, const DetectionState& state,
                         const GainFactors& factors) {
  DetectionUpdate result{std::move(explanation), {}};
  DetectionMoments& posterior = result.posterior;
  if (!std::isfinite(result.log_evidence()) || state.has_slow)
    posterior.covariance = state.covariance;
  if (!std::isfinite(result.log_evidence())) return result;
  if (!state.has_slow) {
    move_pair(state, factors.camera, result);
    return result;
  }
  Vector18d gain = Vector18d::Ones();
  gain.head<6>().setConstant(factors.camera);
  gain.tail<6>().setConstant(factors.slow);
  GaussianUpdate update(gain, posterior.mean, posterior.covariance);
  for (const Innovation& seen : result.explanation.innovations) {
    if (seen.weight > 0.0) update.add(seen, times_ht(state.covariance, seen.slow_map));
  }
  update.finish();
  return result;
}

DetectionUpdate observe(const DetectionState& state, const WeighedObservation& observation,
                        const ObjectSensor& sensor, const GainFactors& factors) {
  Explanation explanation = explain(state, observation, sensor);
  linearise_there(state, observation, sensor, explanation);
  return moved_by(std::move(explanation), state, factors);
}

}  // namespace posemix::internal
