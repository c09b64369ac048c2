// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/update.hpp"

#include <limits>
#include <utility>

namespace posemix {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kPoseDof = 6;

Index offset(std::size_t pose) { return kPoseDof * static_cast<Index>(pose); }

/// The noise covariance carried into the world frame: Ad(E) R Ad(E)^T, E the pose of the axes it is
/// stated in.
Matrix6d world_noise(const NoiseComponent& noise, const SE3d& camera, const SE3d& object) {
  const SE3d mode = object * noise.offset;
  const bool in_camera = noise.frame == NoiseFrame::camera;
  const SE3d axes = in_camera ? SE3d(camera.rotation(), mode.translation()) : mode;
  return axes.adjoint_congruence(noise.covariance);
}

/// The detection freed of its mode: T_camera_object as the component believes it.
SE3d without_offset(const Detection& detection, const NoiseComponent& noise) {
  return detection.camera_object * noise.offset.inverse();
}

/// P H^T for one object: covariance columns of the object less those of the camera.
auto observed_columns(const MatrixXd& covariance, std::size_t object) {
  return covariance.middleCols<kPoseDof>(offset(object)) -
         covariance.middleCols<kPoseDof>(offset(kCamera));
}

Hypothesis extended(const Hypothesis& prior, const SE3d& mean, const Matrix6d& covariance,
                    const MatrixXd& cross) {
  const Index n = prior.dof();
  PoseStackd poses = prior.mean();
  poses.push_back(mean);
  MatrixXd joint(n + kPoseDof, n + kPoseDof);
  joint.topLeftCorner(n, n) = prior.covariance();
  joint.topRightCorner(n, kPoseDof) = cross;
  joint.bottomLeftCorner(kPoseDof, n) = cross.transpose();
  joint.bottomRightCorner<kPoseDof, kPoseDof>() = covariance;
  symmetrize(joint);
  return Hypothesis::trusted(std::move(poses), std::move(joint));
}

/// z, R and the products P H^T and S = H P H^T + R of several detections.
struct Observation {
  VectorXd residual;
  MatrixXd noise;
  MatrixXd p_ht;
  MatrixXd s;

  Observation(const Hypothesis& prior, std::span<const Detection> detections,
              std::span<const NoiseComponent* const> components)
      : residual(offset(detections.size())),
        noise(MatrixXd::Zero(residual.size(), residual.size())),
        p_ht(prior.dof(), residual.size()),
        s(residual.size(), residual.size()) {
    for (std::size_t j = 0; j < detections.size(); ++j) {
      const Innovation one = innovation(prior.mean(), detections[j], *components[j]);
      residual.segment<kPoseDof>(offset(j)) = one.residual;
      noise.block<kPoseDof, kPoseDof>(offset(j), offset(j)) = one.noise;
      p_ht.middleCols<kPoseDof>(offset(j)) =
          observed_columns(prior.covariance(), detections[j].object);
    }
    for (std::size_t j = 0; j < detections.size(); ++j) {
      s.middleRows<kPoseDof>(offset(j)) = p_ht.middleRows<kPoseDof>(offset(detections[j].object)) -
                                          p_ht.middleRows<kPoseDof>(offset(kCamera));
    }
    s += noise;
    symmetrize(s);
  }
};

/// (I - K H) P (I - K H)^T + K R K^T, Joseph's form.
MatrixXd joseph(const MatrixXd& covariance, const MatrixXd& gain, const Observation& observed,
                std::span<const Detection> detections) {
  MatrixXd posterior = covariance;
  posterior.noalias() -= gain * observed.p_ht.transpose();
  MatrixXd rest = gain * observed.noise;
  for (std::size_t j = 0; j < detections.size(); ++j) {
    rest.middleCols<kPoseDof>(offset(j)) -= observed_columns(posterior, detections[j].object);
  }
  posterior.noalias() += rest * gain.transpose();
  symmetrize(posterior);
  return posterior;
}

}  // namespace

Innovation innovation(const PoseStackd& mean, const Detection& detection,
                      const NoiseComponent& noise) {
  const SE3d& camera = mean[kCamera];
  const SE3d& object = mean[detection.object];
  const SE3d detected = camera * without_offset(detection, noise);
  return {(detected * object.inverse()).log(), world_noise(noise, camera, object)};
}

double squared_mahalanobis(const Hypothesis& hypothesis, const Detection& detection,
                           const NoiseComponent& noise) {
  const Innovation one = innovation(hypothesis.mean(), detection, noise);
  const auto p_ht = observed_columns(hypothesis.covariance(), detection.object);
  const Matrix6d s = p_ht.middleRows<kPoseDof>(offset(detection.object)) -
                     p_ht.middleRows<kPoseDof>(offset(kCamera)) + one.noise;
  const Eigen::LLT<Matrix6d> factor(s);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  return factor.matrixL().solve(one.residual).squaredNorm();
}

UpdateResult update(const Hypothesis& prior, std::span<const Detection> detections,
                    std::span<const NoiseComponent* const> noise) {
  if (detections.empty()) return {prior, 0.0, true};
  // Innovation and its covariance, S = H P H^T + R.
  const Observation observed(prior, detections, noise);
  const Eigen::LLT<MatrixXd> s(observed.s);
  if (s.info() != Eigen::Success) {
    return {prior, -std::numeric_limits<double>::infinity(), false};
  }
  // Gain and correction, K = P H^T S^-1, X <- Exp(K z) X.
  const MatrixXd gain = s.solve(observed.p_ht.transpose()).transpose();
  PoseStackd mean = PoseStackd::exp(gain * observed.residual) * prior.mean();
  return {
      Hypothesis::trusted(std::move(mean), joseph(prior.covariance(), gain, observed, detections)),
      log_normal(s, observed.residual), true};
}

Hypothesis with_detected_object(const Hypothesis& prior, const Detection& detection,
                                const NoiseComponent& noise) {
  const SE3d& camera = prior.mean()[kCamera];
  const SE3d object = camera * without_offset(detection, noise);
  const Matrix6d camera_covariance =
      prior.covariance().block<kPoseDof, kPoseDof>(offset(kCamera), offset(kCamera));
  return extended(prior, object, camera_covariance + world_noise(noise, camera, object),
                  prior.covariance().middleCols<kPoseDof>(offset(kCamera)));
}

Hypothesis with_independent_pose(const Hypothesis& prior, const SE3d& mean,
                                 const Matrix6d& covariance) {
  return extended(prior, mean, covariance, MatrixXd::Zero(prior.dof(), kPoseDof));
}

}  // namespace posemix
