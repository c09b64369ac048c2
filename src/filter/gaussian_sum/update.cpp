// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/update.hpp"

#include <array>
#include <limits>
#include <utility>

#include "base/cholesky6.hpp"
#include "innovation_score.hpp"
#include "linearized_update.hpp"
#include "posemix/base/error.hpp"
#include "world_noise.hpp"

namespace posemix {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using namespace internal;

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

}  // namespace

Innovation innovation(const PoseStackd& mean, const Detection& detection,
                      const NoiseComponent& noise) {
  const SE3d& camera = mean[kCamera];
  const SE3d& object = mean[detection.object];
  const SE3d detected = camera * without_offset(detection.camera_object, noise);
  return {(detected * object.inverse()).log(), world_noise(noise, camera, object)};
}

internal::InnovationScore internal::innovation_score(const Hypothesis& hypothesis,
                                                     const Detection& detection,
                                                     const NoiseComponent& noise) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::array given{&noise};
  const NoiseAtMean at_mean(hypothesis.mean(), std::span(&detection, 1), given);
  const Innovation one = innovation(hypothesis.mean(), detection, *at_mean.components().front());
  const MatrixXd& p = hypothesis.covariance();
  const Matrix6d cross = block(p, detection.object, kCamera);
  Matrix6d s = block(p, detection.object, detection.object) + block(p, kCamera, kCamera) - cross -
               cross.transpose() + one.noise;
  symmetrize(s);
  const Cholesky6 factor(s);
  if (!factor.ok()) return {kInfinity, -kInfinity};
  const double squared = factor.whitened(one.residual).squaredNorm();
  return {squared, -0.5 * (squared + factor.log_det() + 6.0 * kLogTwoPi)};
}

double squared_mahalanobis(const Hypothesis& hypothesis, const Detection& detection,
                           const NoiseComponent& noise) {
  return internal::innovation_score(hypothesis, detection, noise).squared;
}

UpdateResult update(const Hypothesis& prior, std::span<const Detection> detections,
                    std::span<const NoiseComponent* const> noise) {
  require(noise.size() == detections.size(),
          "update: not as many noise components as detections, expected one for each");
  if (detections.empty()) return {prior, 0.0, true};
  return std::move(linearized_updates(prior, detections, FrameNoises(noise)).front());
}

Hypothesis with_detected_object(const Hypothesis& prior, const SE3d& camera_object,
                                const NoiseComponent& noise) {
  const SE3d& camera = prior.mean()[kCamera];
  const SE3d object = camera * without_offset(camera_object, noise);
  const MatrixXd& p = prior.covariance();
  return extended(prior, object, block(p, kCamera, kCamera) + world_noise(noise, camera, object),
                  columns(p, kCamera));
}

Hypothesis with_independent_pose(const Hypothesis& prior, const SE3d& mean,
                                 const Matrix6d& covariance) {
  return extended(prior, mean, covariance, MatrixXd::Zero(prior.dof(), kPoseDof));
}

}  // namespace posemix
