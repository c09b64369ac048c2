// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "relative_poses.hpp"

#include <limits>
#include <numbers>
#include <utility>

#include "world_noise.hpp"

namespace posemix::internal {

namespace {

/// L^-1 of a Cholesky factorization L L^T, from the columns of its transpose: X L^T = I.
Matrix6d inverse_of_factor(const Eigen::LLT<Matrix6d>& factor) {
  const Matrix6d& l = factor.matrixLLT();
  Matrix6d x = Matrix6d::Identity();
  for (Eigen::Index j = 0; j < kPoseDof; ++j) {
    for (Eigen::Index k = 0; k < j; ++k) x.col(j) -= x.col(k) * l(j, k);
    x.col(j) /= l(j, j);
  }
  return x.transpose();
}

}  // namespace

template <int Dim>
RelativePrior<Dim>::RelativePrior(const Hypothesis& prior, std::span<const Detection> detections,
                                  std::span<const NoiseComponent* const> noise) {
  poses.reserve(detections.size());
  for (std::size_t j = 0; j < detections.size(); ++j) {
    const Detection& detection = detections[j];
    const SE3d inverse = prior.mean()[detection.object].inverse();
    const Eigen::LLT<Matrix6d> noise_factor(noise[j]->covariance);
    poses.push_back({detection.object, inverse * prior.mean()[kCamera], inverse.adjoint_blocks(),
                     without_offset(detection.camera_object, *noise[j]), noise[j],
                     inverse_of_factor(noise_factor)});
  }
  cross = times_dt(prior.covariance());
  covariance.resize(size(), size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = 0; j < poses.size(); ++j) {
      const Matrix6d difference = block(cross, kCamera, j) - block(cross, poses[i].object, j);
      block(covariance, i, j) = poses[i].to_object.times(difference);
    }
  }
  symmetrize(covariance);
  factor.compute(covariance);
}

template <int Dim>
Tall<Dim> RelativePrior<Dim>::times_dt(const Eigen::MatrixXd& matrix) const {
  Tall<Dim> result = Tall<Dim>::Zero(matrix.rows(), size());
  Tall<kPoseDof> difference(matrix.rows(), kPoseDof);
  for (std::size_t j = 0; j < poses.size(); ++j) {
    difference = columns(matrix, poses[j].object) - columns(matrix, kCamera);
    subtract_product(columns(result, j), difference, poses[j].to_object.dense());
  }
  return result;
}

namespace {

template <int Dim>
class RelativeEstimator {
 public:
  explicit RelativeEstimator(const RelativePrior<Dim>& prior)
      : prior_(prior), parts_(prior.poses.size()) {
    p_mt_.resize(prior.size(), prior.size());
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      set_noise(j, noise_axes(*prior.poses[j].component, prior.poses[j].mean.rotation(), SE3d()));
    }
  }

  RelativePosterior<Dim> solve(const IteratedUpdateSettings& settings) {
    const Vector<Dim> zero = Vector<Dim>::Zero(prior_.size());
    at_ = iterate(zero, zero);
    if (prior_.factor.info() != Eigen::Success || !linearize()) return failure();
    for (int iteration = 0; iteration < settings.max_iterations; ++iteration) {
      // A new linearization so close to the last one would not differ.
      if (step() < settings.tolerance) break;
      if (!linearize()) return failure();
    }
    const auto size = static_cast<double>(prior_.size());
    return {at_.zeta, posterior_covariance(),
            -0.5 * (cost(at_) + log_det(innovation_) + size * kLogTwoPi), true};
  }

 private:
  struct Iterate {
    Vector<Dim> zeta;
    Vector<Dim> information;  ///< P^-1 zeta
    Vector<Dim> n;            ///< Log(Z_j detected_j)
  };

  /// The detection of one relative pose, linearized at an iterate.
  struct Linearization {
    TwistMatrix<double> m;  ///< dn/dzeta
    Matrix6d noise;         ///< R
    Matrix6d whitener;      ///< W with W^T W = R^-1
  };

  Iterate iterate(const Vector<Dim>& zeta, const Vector<Dim>& information) const {
    Iterate next{zeta, information, Vector<Dim>(zeta.size())};
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      const RelativePose& pose = prior_.poses[j];
      segment(next.n, j) = (SE3d::exp(segment(zeta, j)) * pose.mean * pose.detected).log();
    }
    return next;
  }

  /// zeta^T P^-1 zeta + n^T R^-1 n with R at the last linearization.
  double cost(const Iterate& x) const {
    double sum = x.zeta.dot(x.information);
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      sum += (parts_[j].whitener * segment(x.n, j)).squaredNorm();
    }
    return sum;
  }

  /// The same poses by rotations of at most half a turn, where their prior agrees. What several
  /// poses share may be a turn beyond.
  void unwind(Iterate& next) const {
    Vector<Dim> zeta = next.zeta;
    bool is_within = true;
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      if (!(segment(zeta, j).template head<3>().norm() > std::numbers::pi)) continue;
      segment(zeta, j) = SE3d::exp(segment(zeta, j)).log();
      is_within = false;
    }
    if (is_within) return;
    const Iterate unwound = iterate(zeta, prior_.factor.solve(zeta));
    if (cost(unwound) < cost(next)) next = unwound;
  }

  /// Whether J_l(zeta) is far from singular, as it is at a whole turn: the reset of the covariance
  /// would lose what lies across it.
  bool is_near(const Iterate& x) const {
    constexpr double kMostTurn = 1.5 * std::numbers::pi;
    for (std::size_t j = 0; j < parts_.size(); ++j)
      if (!(segment(x.zeta, j).template head<3>().norm() < kMostTurn)) return false;
    return true;
  }

  /// zeta <- -K (n - M zeta). The step is halved while the cost rises with R held fixed, or a pose
  /// turns too far. Returns the length of the step.
  double step() {
    Vector<Dim> target = at_.n;
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      segment(target, j) -= parts_[j].m.times(Vector6d(segment(at_.zeta, j)));
    }
    const Vector<Dim> y = innovation_.solve(target);
    Vector<Dim> change = -at_.zeta - p_mt_ * y;
    Vector<Dim> information_change = -at_.information;
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      segment(information_change, j) -= parts_[j].m.transpose_times(segment(y, j));
    }
    const double highest = cost(at_) * (1.0 + 1e-12);
    const auto stepped = [&] {
      Iterate there = iterate(at_.zeta + change, at_.information + information_change);
      unwind(there);
      return there;
    };
    Iterate next = stepped();
    for (int half = 0; half < kMaxHalvings && (cost(next) > highest || !is_near(next)); ++half) {
      change *= 0.5;
      information_change *= 0.5;
      next = stepped();
    }
    if (!is_near(next)) return 0.0;
    at_ = std::move(next);
    return change.norm();
  }

  /// Sets R of one detection from the pose of the axes in which its noise is stated.
  void set_noise(std::size_t j, const SE3d& axes) {
    const RelativePose& pose = prior_.poses[j];
    parts_[j].noise = axes.adjoint_congruence(pose.component->covariance);
    parts_[j].whitener.noalias() = pose.whitener * axes.inverse().adjoint();
  }

  /// Computes M, R, P M^T and the factor of S = M P M^T + R at the current iterate, where M is the
  /// derivative of n by zeta, M_j = J_l^-1(n_j) J_l(zeta_j). Returns false when S is not positive
  /// definite.
  bool linearize() {
    Square<Dim> s(prior_.size(), prior_.size());
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      const Vector6d zeta = segment(at_.zeta, j);
      const RelativePose& pose = prior_.poses[j];
      if (pose.component->frame == NoiseFrame::camera) {
        const SO3d camera = SO3d::exp(zeta.head<3>()) * pose.mean.rotation();
        set_noise(j, noise_axes(*pose.component, camera, SE3d()));
      }
      parts_[j].m =
          SE3d::left_jacobian_inverse_blocks(segment(at_.n, j)) * SE3d::left_jacobian_blocks(zeta);
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        block(p_mt_, i, j) = parts_[j].m.transpose_after(block(prior_.covariance, i, j));
      }
    }
    // The factorization reads the lower triangle only.
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      for (std::size_t i = j; i < parts_.size(); ++i) {
        block(s, i, j) = parts_[i].m.times(Matrix6d(block(p_mt_, i, j)));
      }
      block(s, j, j) += parts_[j].noise;
    }
    innovation_.compute(s);
    return innovation_.info() == Eigen::Success;
  }

  /// Joseph's form, (I - K M) P (I - K M)^T + K R K^T.
  Square<Dim> posterior_covariance() const {
    const Tall<Dim> gain = times_inverse<Dim>(p_mt_, innovation_);
    Square<Dim> covariance = prior_.covariance;
    covariance.noalias() -= gain * p_mt_.transpose();
    Square<Dim> rest(prior_.size(), prior_.size());
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        Matrix6d difference = -parts_[j].m.transpose_after(block(covariance, i, j));
        difference.noalias() += block(gain, i, j) * parts_[j].noise;
        block(rest, i, j) = difference;
      }
    }
    covariance.noalias() += rest * gain.transpose();
    symmetrize(covariance);
    return covariance;
  }

  RelativePosterior<Dim> failure() const {
    return {at_.zeta, prior_.covariance, -std::numeric_limits<double>::infinity(), false};
  }

  static constexpr int kMaxHalvings = 8;

  const RelativePrior<Dim>& prior_;
  Iterate at_;
  std::vector<Linearization> parts_;
  Square<Dim> p_mt_;  ///< P M^T
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
