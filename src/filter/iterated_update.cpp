// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/iterated_update.hpp"

#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace posemix {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kPoseDof = 6;

Index offset(std::size_t pose) { return kPoseDof * static_cast<Index>(pose); }

/// The prior of the relative poses Z_j = Exp(zeta_j) mean_j, zeta_j = Ad(T_j^-1) (xi_R - xi_j) =: D
/// xi.
struct RelativePrior {
  std::vector<SE3d> mean;
  std::vector<Matrix6d> to_object;  ///< Ad(T_j^-1)
  std::vector<std::size_t> objects;
  MatrixXd cross;       ///< P D^T
  MatrixXd covariance;  ///< D P D^T

  RelativePrior(const Hypothesis& prior, std::span<const Detection> detections)
      : cross(prior.dof(), offset(detections.size())), covariance(cross.cols(), cross.cols()) {
    for (const Detection& detection : detections) {
      const SE3d inverse = prior.mean()[detection.object].inverse();
      mean.push_back(inverse * prior.mean()[kCamera]);
      to_object.push_back(inverse.adjoint());
      objects.push_back(detection.object);
    }
    times_d_transposed(prior.covariance(), cross);
    for (std::size_t j = 0; j < objects.size(); ++j) {
      covariance.middleRows<kPoseDof>(offset(j)) =
          to_object[j] * (cross.middleRows<kPoseDof>(offset(kCamera)) -
                          cross.middleRows<kPoseDof>(offset(objects[j])));
    }
    symmetrize(covariance);
  }

  /// matrix D^T
  void times_d_transposed(const MatrixXd& matrix, MatrixXd& result) const {
    for (std::size_t j = 0; j < objects.size(); ++j) {
      result.middleCols<kPoseDof>(offset(j)).noalias() =
          (matrix.middleCols<kPoseDof>(offset(kCamera)) -
           matrix.middleCols<kPoseDof>(offset(objects[j]))) *
          to_object[j].transpose();
    }
  }
};

/// Detection noise n_j = Log(Z_j Y_j offset^-1) at given relative poses, its covariance and its
/// Jacobian J_l^-1(n_j).
struct Residual {
  VectorXd n;
  MatrixXd noise;
  MatrixXd jacobian;

  Residual(const std::vector<SE3d>& relative, std::span<const Detection> detections,
           std::span<const NoiseComponent* const> components)
      : n(offset(detections.size())),
        noise(MatrixXd::Zero(n.size(), n.size())),
        jacobian(MatrixXd::Zero(n.size(), n.size())) {
    for (std::size_t j = 0; j < detections.size(); ++j) {
      const NoiseComponent& component = *components[j];
      const SE3d& z = relative[j];
      const Vector6d one = (z * detections[j].camera_object * component.offset.inverse()).log();
      const bool in_camera = component.frame == NoiseFrame::camera;
      const SE3d axes =
          in_camera ? SE3d(z.rotation(), component.offset.translation()) : component.offset;
      n.segment<kPoseDof>(offset(j)) = one;
      noise.block<kPoseDof, kPoseDof>(offset(j), offset(j)) =
          axes.adjoint_congruence(component.covariance);
      jacobian.block<kPoseDof, kPoseDof>(offset(j), offset(j)) = SE3d::left_jacobian_inverse(one);
    }
  }
};

/// The solution of the Gauss-Newton iteration.
struct RelativePosterior {
  VectorXd zeta;        ///< of the solution, in the tangent space at the prior mean
  MatrixXd covariance;  ///< there
  double log_likelihood;
  bool ok;
};

/// Gauss-Newton on |zeta|^2_P + |n|^2_R over the relative poses.
class RelativeEstimator {
 public:
  RelativeEstimator(const RelativePrior& prior, std::span<const Detection> detections,
                    std::span<const NoiseComponent* const> components)
      : prior_(prior),
        detections_(detections),
        components_(components),
        prior_factor_(prior.covariance),
        z_(prior.mean),
        zeta_(VectorXd::Zero(prior.covariance.rows())) {}

  RelativePosterior solve(const IteratedUpdateSettings& settings) {
    if (prior_factor_.info() != Eigen::Success) return failure();
    double cost = cost_at(z_, zeta_);
    for (int iteration = 0; iteration < settings.max_iterations; ++iteration) {
      if (!linearize()) return failure();
      // delta = -zeta - K (n - H zeta), shortened until the cost does not rise.
      VectorXd step = -zeta_ - gain_ * (residual_->n - residual_->jacobian * zeta_);
      std::vector<SE3d> z = moved(step);
      VectorXd zeta = zeta_of(z);
      double next = cost_at(z, zeta);
      for (int half = 0; half < 8 && next > cost * (1.0 + 1e-12); ++half) {
        step *= 0.5;
        z = moved(step);
        zeta = zeta_of(z);
        next = cost_at(z, zeta);
      }
      z_ = std::move(z);
      zeta_ = std::move(zeta);
      cost = next;
      if (step.norm() < settings.tolerance) break;
    }
    if (!linearize()) return failure();
    return {zeta_, posterior_covariance(),
            -0.5 * (cost + log_det(innovation_) + static_cast<double>(zeta_.size()) * kLogTwoPi),
            true};
  }

 private:
  RelativePosterior failure() const {
    return {zeta_, prior_.covariance, -std::numeric_limits<double>::infinity(), false};
  }

  /// K, H and R at the current relative poses; false when the innovation covariance is not positive
  /// definite.
  bool linearize() {
    residual_.emplace(z_, detections_, components_);
    chart_ = MatrixXd::Zero(zeta_.size(), zeta_.size());
    for (std::size_t j = 0; j < z_.size(); ++j) {
      chart_.block<kPoseDof, kPoseDof>(offset(j), offset(j)) =
          SE3d::left_jacobian(zeta_.segment<kPoseDof>(offset(j)));
    }
    here_ = chart_ * prior_.covariance * chart_.transpose();
    const MatrixXd p_ht = here_ * residual_->jacobian.transpose();
    MatrixXd s = residual_->jacobian * p_ht + residual_->noise;
    symmetrize(s);
    innovation_.compute(s);
    if (innovation_.info() != Eigen::Success) return false;
    gain_ = innovation_.solve(p_ht.transpose()).transpose();
    return true;
  }

  std::vector<SE3d> moved(const VectorXd& step) const {
    std::vector<SE3d> z = z_;
    for (std::size_t j = 0; j < z.size(); ++j)
      z[j] = SE3d::exp(step.segment<kPoseDof>(offset(j))) * z[j];
    return z;
  }

  VectorXd zeta_of(const std::vector<SE3d>& z) const {
    VectorXd zeta(zeta_.size());
    for (std::size_t j = 0; j < z.size(); ++j) {
      zeta.segment<kPoseDof>(offset(j)) = (z[j] * prior_.mean[j].inverse()).log();
    }
    return zeta;
  }

  double cost_at(const std::vector<SE3d>& z, const VectorXd& zeta) const {
    const Residual residual(z, detections_, components_);
    return prior_factor_.matrixL().solve(zeta).squaredNorm() +
           residual.n.dot(Eigen::LLT<MatrixXd>(residual.noise).solve(residual.n));
  }

  /// Joseph's form at the solution, carried back to the tangent space at the prior mean.
  MatrixXd posterior_covariance() const {
    const MatrixXd rest =
        MatrixXd::Identity(zeta_.size(), zeta_.size()) - gain_ * residual_->jacobian;
    const MatrixXd at_solution =
        rest * here_ * rest.transpose() + gain_ * residual_->noise * gain_.transpose();
    const Eigen::PartialPivLU<MatrixXd> chart(chart_);
    MatrixXd covariance = chart.solve(chart.solve(at_solution).transpose());
    symmetrize(covariance);
    return covariance;
  }

  const RelativePrior& prior_;
  std::span<const Detection> detections_;
  std::span<const NoiseComponent* const> components_;
  Eigen::LLT<MatrixXd> prior_factor_;
  std::vector<SE3d> z_;
  VectorXd zeta_;
  std::optional<Residual> residual_;
  MatrixXd chart_;  ///< J_l(zeta_j), block by block
  MatrixXd here_;   ///< prior covariance in the tangent space at z_
  MatrixXd gain_;
  Eigen::LLT<MatrixXd> innovation_;
};

/// The pose that each pose is taken relative to: the camera to the first object seen, the other
/// objects seen to the camera, everything else to the first object seen. That one, and the motion
/// of the camera, have no parent (are their own).
std::vector<std::size_t> parents(std::size_t poses, std::span<const Detection> detections,
                                 std::size_t first_object) {
  const std::size_t anchor = detections.front().object;
  std::vector<std::size_t> parent(poses, anchor);
  for (std::size_t k = kCamera + 1; k < first_object; ++k) parent[k] = k;
  for (const Detection& detection : detections.subspan(1)) parent[detection.object] = kCamera;
  return parent;
}

/// The poses from parents to children.
std::vector<std::size_t> top_down(const std::vector<std::size_t>& parent, std::size_t anchor) {
  std::vector<std::size_t> order{anchor, kCamera};
  for (std::size_t k = 0; k < parent.size(); ++k) {
    if (k != anchor && k != kCamera) order.push_back(k);
  }
  return order;
}

/// Moves a Gaussian N(xi, P) in the tangent space at `mean` to its own mean, pose by pose relative
/// to the parent p:
///   T_k <- T_p Exp(zeta_k) T_p^-1 T_k,  zeta_k = Ad(T_p^-1) (xi_k - xi_p),
///   xi_k <- xi_p + M_k (xi_k - xi_p),   M_k = Ad(T_p new) J_l(zeta_k) Ad(T_p^-1).
Hypothesis back_project_relative(const PoseStackd& mean, const VectorXd& xi, MatrixXd covariance,
                                 const std::vector<std::size_t>& parent, std::size_t anchor) {
  using Rows = Eigen::Matrix<double, kPoseDof, Eigen::Dynamic>;
  const std::vector<std::size_t> order = top_down(parent, anchor);
  PoseStackd moved = mean;
  std::vector<Matrix6d> reset(mean.size());
  for (const std::size_t k : order) {
    const std::size_t p = parent[k];
    const Vector6d xi_k = xi.segment<kPoseDof>(offset(k));
    if (p == k) {
      moved[k] = SE3d::exp(xi_k) * mean[k];
      reset[k] = SE3d::left_jacobian(xi_k);
      continue;
    }
    const SE3d to_parent = mean[p].inverse();
    const Vector6d zeta = to_parent.adjoint() * (xi_k - xi.segment<kPoseDof>(offset(p)));
    moved[k] = moved[p] * SE3d::exp(zeta) * (to_parent * mean[k]);
    reset[k] = moved[p].adjoint() * SE3d::left_jacobian(zeta) * to_parent.adjoint();
  }
  // L P L^T: rows, then (of the transpose) columns.
  for (int side = 0; side < 2; ++side) {
    const MatrixXd before = covariance;
    for (const std::size_t k : order) {
      const std::size_t p = parent[k];
      Rows rows = before.middleRows<kPoseDof>(offset(k));
      if (p != k) rows -= before.middleRows<kPoseDof>(offset(p));
      covariance.middleRows<kPoseDof>(offset(k)).noalias() = reset[k] * rows;
      if (p != k)
        covariance.middleRows<kPoseDof>(offset(k)) += covariance.middleRows<kPoseDof>(offset(p));
    }
    covariance.transposeInPlace();
  }
  symmetrize(covariance);
  return Hypothesis::trusted(std::move(moved), std::move(covariance));
}

}  // namespace

UpdateResult iterated_update(const Hypothesis& prior, std::span<const Detection> detections,
                             std::span<const NoiseComponent* const> noise, std::size_t first_object,
                             const IteratedUpdateSettings& settings) {
  if (detections.empty()) return {prior, 0.0, true};
  // The relative poses that are seen.
  const RelativePrior relative(prior, detections);
  const RelativePosterior solution = RelativeEstimator(relative, detections, noise).solve(settings);
  if (!solution.ok) return {prior, solution.log_likelihood, false};

  // Everything else by regression on them: xi = G zeta, P <- (I - G D) P (I - G D)^T + G S G^T.
  const Eigen::LLT<MatrixXd> factor(relative.covariance);
  const MatrixXd g = factor.solve(relative.cross.transpose()).transpose();
  MatrixXd covariance = prior.covariance();
  covariance.noalias() -= g * relative.cross.transpose();
  MatrixXd rest = g * solution.covariance;
  MatrixXd remaining(prior.dof(), rest.cols());
  relative.times_d_transposed(covariance, remaining);
  rest -= remaining;
  covariance.noalias() += rest * g.transpose();

  const std::size_t anchor = detections.front().object;
  return {back_project_relative(prior.mean(), g * solution.zeta, std::move(covariance),
                                parents(prior.mean().size(), detections, first_object), anchor),
          solution.log_likelihood, true};
}

}  // namespace posemix
