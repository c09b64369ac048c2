// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "linearized_update.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/cholesky6.hpp"
#include "base/dense_kernels.hpp"
#include "base/kept_matrices.hpp"
#include "innovations.hpp"
#include "lie/pose_kernels.hpp"
#include "world_noise.hpp"

namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

double log_det_of(const Matrix6d& covariance) {
  const Cholesky6 factor(covariance);
  return factor.ok() ? factor.log_det() : -std::numeric_limits<double>::infinity();
}

/// `result` becomes matrix H^T: the columns of each object minus those of the camera.
void set_times_ht(const MatrixXd& matrix, std::span<const Detection> detections, MatrixRef result) {
  const auto camera = columns(matrix, kCamera);
  for (std::size_t j = 0; j < detections.size(); ++j)
    set_difference(columns(result, j), columns(matrix, detections[j].object), camera);
}

/// A copy, or the matrix itself where nothing else needs it. Both have one size.
void take(MatrixXd& from, bool is_last, MatrixXd& to) {
  if (is_last) {
    std::swap(from, to);
  } else {
    std::copy_n(from.data(), from.size(), to.data());
  }
}

/// Memory of updates, which a thread keeps.
struct Workspace {
  Innovations seen;                    ///< by noise, then by detection
  std::vector<double> log_dets_noise;  ///< of their noise
  MatrixXd p_ht;                       ///< P H^T, and room for a row below
  MatrixXd h_p_ht;                     ///< the lower triangle of H P H^T
  MatrixXd s;                          ///< S = H P H^T + R, then its factor L
  MatrixXd gain;  ///< W = P H^T L^-T, and z^T L^-T as the row below; then K = W L^-1
  MatrixXd rest;
  bool keeps_digits;           ///< whether P - W W^T does
  Eigen::VectorXd whitened;    ///< L^-1 z
  Eigen::VectorXd correction;  ///< K z = W L^-1 z

  void resize(Index n, Index m) {
    p_ht.resize(n + 1, m);
    h_p_ht.resize(m, m);
    s.resize(m, m);
    gain.resize(n + 1, m);
    rest.resize(n, m);
  }

  void set_innovations(const PoseStackd& mean, std::span<const Detection> detections,
                       const FrameNoises& noises) {
    const NoiseAtMean at_mean(mean, detections, noises.components);
    const auto components = at_mean.components();
    seen.set(mean, detections, components);
    log_dets_noise = noises.log_dets;
    for (std::size_t i = 0; i < components.size(); ++i) {
      if (components[i] != noises.components[i])
        log_dets_noise[i] = log_det_of(components[i]->covariance);
    }
  }
};

/// P H^T, and the lower triangle of H P H^T.
void observe(const Hypothesis& prior, std::span<const Detection> detections, Workspace& work) {
  set_times_ht(prior.covariance(), detections, work.p_ht.topRows(prior.dof()));
  for (std::size_t j = 0; j < detections.size(); ++j) {
    for (std::size_t i = j; i < detections.size(); ++i) {
      block(work.h_p_ht, i, j) =
          block(work.p_ht, detections[i].object, j) - block(work.p_ht, kCamera, j);
    }
  }
}

/// Up to this ratio of variances P - W W^T keeps six digits at least that Joseph's form keeps.
constexpr double kMostShrinking = 1e9;

/// No eigenvalue of R^-1 S, by which variances shrink, is larger than one plus the sum over the
/// detections of those of R_j^-1 S_jj, each of which is at most the ratio of their determinants.
bool keeps_digits(const MatrixXd& s, std::span<const double> log_dets_noise) {
  const double most = std::log(kMostShrinking / static_cast<double>(log_dets_noise.size()));
  for (std::size_t j = 0; j < log_dets_noise.size(); ++j) {
    const Cholesky6 own(block(s, j, j));
    if (!own.ok() || !(own.log_det() - log_dets_noise[j] <= most)) return false;
  }
  return true;
}

/// The factor of S and W, for the innovations from index `first` on. False where S is not positive
/// definite. What the noises share is lost with the last one.
bool whiten(std::size_t first, Workspace& work) {
  const auto count = static_cast<std::size_t>(work.s.rows() / kPoseDof);
  const bool is_last = first + count == work.seen.noise.size();
  take(work.h_p_ht, is_last, work.s);
  take(work.p_ht, is_last, work.gain);
  for (std::size_t j = 0; j < count; ++j) block(work.s, j, j) += work.seen.noise[first + j];
  work.keeps_digits = keeps_digits(work.s, std::span(work.log_dets_noise).subspan(first, count));
  if (!factor_in_place(work.s)) return false;
  const Index n = work.rest.rows();
  work.gain.row(n) = work.seen.residual.segment(offset(first), work.s.rows()).transpose();
  solve_transposed_from_right(work.s, work.gain);
  work.whitened = work.gain.row(n).transpose();
  return true;
}

/// Joseph's form of P - W W^T: P' = (I - K H) P, then P <- P' - (P' H^T - K R) K^T.
void joseph(std::span<const Detection> detections, std::size_t first, Workspace& work,
            MatrixXd& covariance) {
  solve_after_transposed(work.s, work.gain);
  const auto gain = work.gain.topRows(covariance.rows());
  set_times_ht(covariance, detections, work.rest);
  subtract_symmetric_product(covariance, gain, work.rest);
  set_times_ht(covariance, detections, work.rest);
  for (std::size_t j = 0; j < detections.size(); ++j)
    subtract_product(columns(work.rest, j), columns(gain, j), work.seen.noise[first + j]);
  subtract_symmetric_product(covariance, work.rest, gain);
}

/// Moves the hypothesis by the innovations from index `first` on, which are whitened.
Hypothesis moved(const Hypothesis& prior, std::span<const Detection> detections, std::size_t first,
                 Workspace& work) {
  // Correction, X <- Exp(K z) X with K = P H^T S^-1.
  const auto w = work.gain.topRows(prior.dof());
  set_product(work.correction, w, work.whitened);
  PoseStackd mean(prior.mean().size());
  exp_product_of({work.correction.data(), kPoseDof}, rows_of(prior.mean().poses().data()),
                 rows_of(&mean[0]), mean.size());
  if (work.keeps_digits) {
    MatrixXd covariance = kept_matrix(prior.dof());
    set_symmetric_difference(covariance, prior.covariance(), w, w);
    return Hypothesis::trusted(std::move(mean), std::move(covariance));
  }
  MatrixXd covariance = kept_copy(prior.covariance());
  joseph(detections, first, work, covariance);
  return Hypothesis::trusted(std::move(mean), std::move(covariance));
}

}  // namespace

FrameNoises::FrameNoises(std::span<const NoiseComponent* const> given)
    : components(given.begin(), given.end()) {
  log_dets.reserve(given.size());
  for (const NoiseComponent* component : given)
    log_dets.push_back(log_det_of(component->covariance));
}

KeptVector<UpdateResult> linearized_updates(const Hypothesis& prior,
                                            std::span<const Detection> detections,
                                            const FrameNoises& noises) {
  static thread_local Workspace work;
  const std::size_t count = detections.size();
  work.resize(prior.dof(), offset(count));
  // Innovations under all noises, and what they share of S = H P H^T + R.
  work.set_innovations(prior.mean(), detections, noises);
  observe(prior, detections, work);
  KeptVector<UpdateResult> results;
  results.reserve(noises.components.size() / count);
  for (std::size_t first = 0; first < noises.components.size(); first += count) {
    if (!whiten(first, work)) {
      results.push_back({prior, -std::numeric_limits<double>::infinity(), false});
      continue;
    }
    const double log_likelihood = -0.5 * (work.whitened.squaredNorm() + log_det_of_factor(work.s) +
                                          static_cast<double>(work.whitened.size()) * kLogTwoPi);
    results.push_back({moved(prior, detections, first, work), log_likelihood, true});
  }
  return results;
}

}  // namespace posemix::internal
