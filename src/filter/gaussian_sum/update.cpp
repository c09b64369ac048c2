// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/update.hpp"

#include <array>
#include <limits>
#include <utility>

#include "innovation_score.hpp"
#include "symmetric_products.hpp"
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

/// matrix H^T: the columns of each object minus those of the camera.
template <int Dim>
Tall<Dim> times_ht(const MatrixXd& matrix, std::span<const Detection> detections) {
  Tall<Dim> result(matrix.rows(), offset(detections.size()));
  for (std::size_t j = 0; j < detections.size(); ++j) {
    columns(result, j) = columns(matrix, detections[j].object) - columns(matrix, kCamera);
  }
  return result;
}

/// z, R and the products P H^T and S = H P H^T + R of several detections.
template <int Dim>
struct LinearObservation {
  Vector<Dim> residual;
  Square<Dim> noise;
  Tall<Dim> p_ht;
  Square<Dim> s;

  LinearObservation(const Hypothesis& prior, std::span<const Detection> detections,
                    std::span<const NoiseComponent* const> components)
      : p_ht(times_ht<Dim>(prior.covariance(), detections)) {
    const Index size = offset(detections.size());
    residual.resize(size);
    noise.setZero(size, size);
    s.resize(size, size);
    for (std::size_t j = 0; j < detections.size(); ++j) {
      const Innovation one = innovation(prior.mean(), detections[j], *components[j]);
      segment(residual, j) = one.residual;
      block(noise, j, j) = one.noise;
      rows(s, j) = rows(p_ht, detections[j].object) - rows(p_ht, kCamera);
    }
    s += noise;
    symmetrize(s);
  }
};

template <int Dim>
UpdateResult update_with(const Hypothesis& prior, std::span<const Detection> detections,
                         std::span<const NoiseComponent* const> noise) {
  // Innovation and its covariance, S = H P H^T + R.
  const LinearObservation<Dim> observed(prior, detections, noise);
  const Eigen::LLT<Square<Dim>> s(observed.s);
  if (s.info() != Eigen::Success) {
    return {prior, -std::numeric_limits<double>::infinity(), false};
  }
  // Gain and correction, K = P H^T S^-1, X <- Exp(K z) X.
  const Tall<Dim> gain = internal::times_inverse<Dim>(observed.p_ht, s);
  PoseStackd mean = prior.mean();
  for (std::size_t k = 0; k < mean.size(); ++k) {
    mean[k] = SE3d::exp(rows(gain, k) * observed.residual) * mean[k];
  }
  // Joseph's form: P' = (I - K H) P, then P <- P' - (P' H^T - K R) K^T.
  MatrixXd covariance = prior.covariance();
  internal::subtract_symmetric_product<Dim>(covariance, gain, observed.p_ht);
  Tall<Dim> rest = times_ht<Dim>(covariance, detections);
  for (std::size_t j = 0; j < detections.size(); ++j) {
    const Matrix6d noise_j = block(observed.noise, j, j);
    for (std::size_t k = 0; k < mean.size(); ++k) {
      block(rest, k, j).noalias() -= block(gain, k, j) * noise_j;
    }
  }
  internal::subtract_symmetric_product<Dim>(covariance, rest, gain);
  return {Hypothesis::trusted(std::move(mean), std::move(covariance)),
          log_normal(s, observed.residual), true};
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
  const std::span<const Detection> detections(&detection, 1);
  const NoiseAtMean at_mean(hypothesis.mean(), detections, given);
  const LinearObservation<kPoseDof> one(hypothesis, detections, at_mean.components());
  const Eigen::LLT<Matrix6d> factor(one.s);
  if (factor.info() != Eigen::Success) return {kInfinity, -kInfinity};
  const Vector6d residual = one.residual;
  return {factor.matrixL().solve(residual).squaredNorm(), log_normal(factor, residual)};
}

double squared_mahalanobis(const Hypothesis& hypothesis, const Detection& detection,
                           const NoiseComponent& noise) {
  return internal::innovation_score(hypothesis, detection, noise).squared;
}

UpdateResult update(const Hypothesis& prior, std::span<const Detection> detections,
                    std::span<const NoiseComponent* const> noise) {
  if (detections.empty()) return {prior, 0.0, true};
  const internal::NoiseAtMean at_mean(prior.mean(), detections, noise);
  if (detections.size() == 1) return update_with<kPoseDof>(prior, detections, at_mean.components());
  return update_with<Eigen::Dynamic>(prior, detections, at_mean.components());
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
