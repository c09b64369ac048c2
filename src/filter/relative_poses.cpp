// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "relative_poses.hpp"

#include <limits>
#include <utility>

#include "noise_axes.hpp"

namespace posemix::internal {

template <int Dim>
RelativePrior<Dim>::RelativePrior(const Hypothesis& prior, std::span<const Detection> detections,
                                  std::span<const NoiseComponent* const> noise) {
  poses.reserve(detections.size());
  for (std::size_t j = 0; j < detections.size(); ++j) {
    const Detection& detection = detections[j];
    const SE3d inverse = prior.mean()[detection.object].inverse();
    poses.push_back({detection.object, inverse * prior.mean()[kCamera], inverse.adjoint(),
                     without_offset(detection, *noise[j]), noise[j],
                     Eigen::LLT<Matrix6d>(noise[j]->covariance)});
  }
  cross = times_dt(prior.covariance());
  covariance.resize(size(), size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = 0; j < poses.size(); ++j) {
      const Matrix6d difference = block(cross, kCamera, j) - block(cross, poses[i].object, j);
      block(covariance, i, j).noalias() = poses[i].to_object * difference;
    }
  }
  symmetrize(covariance);
  factor.compute(covariance);
}

template <int Dim>
Tall<Dim> RelativePrior<Dim>::times_dt(const Eigen::MatrixXd& matrix) const {
  Tall<Dim> result(matrix.rows(), size());
  for (std::size_t j = 0; j < poses.size(); ++j) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(matrix.rows() / kPoseDof); ++k) {
      const Matrix6d difference = block(matrix, k, kCamera) - block(matrix, k, poses[j].object);
      block(result, k, j).noalias() = difference * poses[j].to_object.transpose();
    }
  }
  return result;
}

namespace {

template <int Dim>
class RelativeEstimator {
 public:
  explicit RelativeEstimator(const RelativePrior<Dim>& prior)
      : prior_(prior), at_(iterate(Vector<Dim>::Zero(prior.size()))) {
    p_mt_.resize(prior.size(), prior.size());
    m_.resize(prior.poses.size());
  }

  RelativePosterior<Dim> solve(const IteratedUpdateSettings& settings) {
    if (prior_.factor.info() != Eigen::Success || !linearize()) return failure();
    for (int iteration = 0; iteration < settings.max_iterations; ++iteration) {
      // zeta <- -K (n - M zeta), the step shortened until the cost does not rise.
      Vector<Dim> step = -at_.zeta - p_mt_ * innovation_.solve(at_.n - m_times(at_.zeta));
      Iterate next = iterate(at_.zeta + step);
      for (int half = 0; half < 8 && next.cost > at_.cost * (1.0 + 1e-12); ++half) {
        step *= 0.5;
        next = iterate(at_.zeta + step);
      }
      at_ = std::move(next);
      if (!linearize()) return failure();
      if (step.norm() < settings.tolerance) break;
    }
    const auto size = static_cast<double>(prior_.size());
    return {at_.zeta, posterior_covariance(),
            -0.5 * (at_.cost + log_det(innovation_) + size * kLogTwoPi), true};
  }

 private:
  /// A value of zeta and what the cost there needs.
  struct Iterate {
    Vector<Dim> zeta;
    Vector<Dim> n;      ///< Log(Z_j detected_j)
    Square<Dim> noise;  ///< R, block by block
    double cost;        ///< zeta^T P^-1 zeta + n^T R^-1 n
  };

  Iterate iterate(const Vector<Dim>& zeta) const {
    const Eigen::Index size = prior_.size();
    Iterate next{zeta, Vector<Dim>(size), Square<Dim>::Zero(size, size), 0.0};
    next.cost = prior_.factor.matrixL().solve(zeta).squaredNorm();
    for (std::size_t j = 0; j < prior_.poses.size(); ++j) {
      const RelativePose& pose = prior_.poses[j];
      const SE3d z = SE3d::exp(segment(zeta, j)) * pose.mean;
      const Vector6d n = (z * pose.detected).log();
      const SE3d axes = noise_axes(*pose.component, z.rotation(), SE3d());
      const Vector6d in_axes = axes.inverse().adjoint() * n;
      segment(next.n, j) = n;
      block(next.noise, j, j) = axes.adjoint_congruence(pose.component->covariance);
      next.cost += pose.noise_factor.matrixL().solve(in_axes).squaredNorm();
    }
    return next;
  }

  /// M, P M^T and the factor of S = M P M^T + R at the current iterate, M the derivative of n by
  /// zeta, M_j = J_l^-1(n_j) J_l(zeta_j); false when S is not positive definite.
  bool linearize() {
    for (std::size_t j = 0; j < m_.size(); ++j) {
      m_[j].noalias() = SE3d::left_jacobian_inverse(segment(at_.n, j)) *
                        SE3d::left_jacobian(segment(at_.zeta, j));
      columns(p_mt_, j).noalias() = columns(prior_.covariance, j) * m_[j].transpose();
    }
    Square<Dim> s = at_.noise;
    for (std::size_t j = 0; j < m_.size(); ++j) rows(s, j).noalias() += m_[j] * rows(p_mt_, j);
    symmetrize(s);
    innovation_.compute(s);
    return innovation_.info() == Eigen::Success;
  }

  Vector<Dim> m_times(const Vector<Dim>& zeta) const {
    Vector<Dim> result(zeta.size());
    for (std::size_t j = 0; j < m_.size(); ++j) {
      segment(result, j).noalias() = m_[j] * segment(zeta, j);
    }
    return result;
  }

  /// Joseph's form, (I - K M) P (I - K M)^T + K R K^T.
  Square<Dim> posterior_covariance() const {
    const Tall<Dim> gain = times_inverse<Dim>(p_mt_, innovation_);
    Square<Dim> covariance = prior_.covariance;
    covariance.noalias() -= gain * p_mt_.transpose();
    Square<Dim> rest = gain * at_.noise;
    for (std::size_t j = 0; j < m_.size(); ++j) {
      columns(rest, j).noalias() -= columns(covariance, j) * m_[j].transpose();
    }
    covariance.noalias() += rest * gain.transpose();
    symmetrize(covariance);
    return covariance;
  }

  RelativePosterior<Dim> failure() const {
    return {at_.zeta, prior_.covariance, -std::numeric_limits<double>::infinity(), false};
  }

  const RelativePrior<Dim>& prior_;
  Iterate at_;
  std::vector<Matrix6d> m_;  ///< M, block by block
  Square<Dim> p_mt_;         ///< P M^T
  Eigen::LLT<Square<Dim>> innovation_;
};

}  // namespace

template <int Dim>
RelativePosterior<Dim> estimate(const RelativePrior<Dim>& prior,
                                const IteratedUpdateSettings& settings) {
  return RelativeEstimator<Dim>(prior).solve(settings);
}

template struct RelativePrior<kPoseDof>;
template struct RelativePrior<Eigen::Dynamic>;
template RelativePosterior<kPoseDof> estimate(const RelativePrior<kPoseDof>&,
                                              const IteratedUpdateSettings&);
template RelativePosterior<Eigen::Dynamic> estimate(const RelativePrior<Eigen::Dynamic>&,
                                                    const IteratedUpdateSettings&);

}  // namespace posemix::internal
