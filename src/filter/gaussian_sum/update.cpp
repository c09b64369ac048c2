// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/update.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "base/dense_kernels.hpp"
#include "base/kept_matrices.hpp"
#include "innovation_score.hpp"
#include "innovations.hpp"
#include "lie/pose_kernels.hpp"
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

/// `result` becomes matrix H^T: the columns of each object minus those of the camera.
void set_times_ht(const MatrixXd& matrix, std::span<const Detection> detections, MatrixRef result) {
  const auto camera = columns(matrix, kCamera);
  for (std::size_t j = 0; j < detections.size(); ++j)
    set_difference(columns(result, j), columns(matrix, detections[j].object), camera);
}

/// Memory of an update, which a thread keeps.
struct Workspace {
  Innovations seen;
  MatrixXd p_ht;  ///< P H^T, and z^T as the row below
  MatrixXd s;     ///< S = H P H^T + R, then its factor
  MatrixXd gain;  ///< K = P H^T S^-1, and z^T S^-1
  MatrixXd rest;

  void resize(Index n, Index m) {
    p_ht.resize(n + 1, m);
    gain.resize(n + 1, m);
    s.resize(m, m);
    rest.resize(n, m);
  }
};

/// P H^T, and the lower triangle of S.
void observe(const Hypothesis& prior, std::span<const Detection> detections, Workspace& work) {
  const Index n = prior.dof();
  set_times_ht(prior.covariance(), detections, work.p_ht.topRows(n));
  work.p_ht.row(n) = work.seen.residual.transpose();
  for (std::size_t j = 0; j < detections.size(); ++j) {
    for (std::size_t i = j; i < detections.size(); ++i) {
      block(work.s, i, j) =
          block(work.p_ht, detections[i].object, j) - block(work.p_ht, kCamera, j);
    }
    block(work.s, j, j) += work.seen.noise[j];
  }
}

/// Joseph's form: P' = (I - K H) P, then P <- P' - (P' H^T - K R) K^T.
MatrixXd joseph(const Hypothesis& prior, std::span<const Detection> detections, Workspace& work) {
  const Index n = prior.dof();
  const auto gain = work.gain.topRows(n);
  MatrixXd covariance = kept_copy(prior.covariance());
  subtract_symmetric_product(covariance, gain, work.p_ht.topRows(n));
  set_times_ht(covariance, detections, work.rest);
  for (std::size_t j = 0; j < detections.size(); ++j)
    subtract_product(columns(work.rest, j), columns(gain, j), work.seen.noise[j]);
  subtract_symmetric_product(covariance, work.rest, gain);
  return covariance;
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
  const Eigen::LLT<Matrix6d> factor(s);
  if (factor.info() != Eigen::Success) return {kInfinity, -kInfinity};
  return {factor.matrixL().solve(one.residual).squaredNorm(), log_normal(factor, one.residual)};
}

double squared_mahalanobis(const Hypothesis& hypothesis, const Detection& detection,
                           const NoiseComponent& noise) {
  return internal::innovation_score(hypothesis, detection, noise).squared;
}

UpdateResult update(const Hypothesis& prior, std::span<const Detection> detections,
                    std::span<const NoiseComponent* const> noise) {
  if (detections.empty()) return {prior, 0.0, true};
  const internal::NoiseAtMean at_mean(prior.mean(), detections, noise);
  static thread_local Workspace work;
  const Index n = prior.dof();
  const Index m = offset(detections.size());
  work.resize(n, m);
  // Innovation and its covariance, S = H P H^T + R.
  work.seen.set(prior.mean(), detections, at_mean.components());
  observe(prior, detections, work);
  if (!factor_in_place(work.s)) return {prior, -std::numeric_limits<double>::infinity(), false};
  std::copy_n(work.p_ht.data(), work.p_ht.size(), work.gain.data());
  solve_transposed_from_right(work.s, work.gain);
  const double log_likelihood = -0.5 * (work.gain.row(n).squaredNorm() + log_det_of_factor(work.s) +
                                        static_cast<double>(m) * kLogTwoPi);
  // Gain and correction, K = P H^T S^-1, X <- Exp(K z) X.
  solve_after_transposed(work.s, work.gain);
  Eigen::VectorXd correction;
  set_product(correction, work.gain.topRows(n), work.seen.residual);
  PoseStackd mean(prior.mean().size());
  exp_product_of({correction.data(), kPoseDof}, rows_of(prior.mean().poses().data()),
                 rows_of(&mean[0]), mean.size());
  return {Hypothesis::trusted(std::move(mean), joseph(prior, detections, work)), log_likelihood,
          true};
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
