// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/iterated_update.hpp"

#include <limits>
#include <utility>
#include <vector>

namespace posemix {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kPoseDof = 6;

Index offset(std::size_t pose) { return kPoseDof * static_cast<Index>(pose); }

template <int Dim>
using Square = Eigen::Matrix<double, Dim, Dim>;
template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;

/// The prior of the relative poses Z_j = Exp(zeta_j) mean_j, zeta_j = Ad(T_j^-1) (xi_R - xi_j) =:
/// (D xi)_j. Dim is six times the number of detections, or dynamic.
template <int Dim>
struct RelativePrior {
  std::vector<SE3d> mean;
  std::vector<Matrix6d> to_object;  ///< Ad(T_j^-1)
  std::vector<std::size_t> objects;
  Eigen::Matrix<double, Eigen::Dynamic, Dim> cross;  ///< P D^T
  Square<Dim> covariance;                            ///< D P D^T

  RelativePrior(const Hypothesis& prior, std::span<const Detection> detections) {
    for (const Detection& detection : detections) {
      const SE3d inverse = prior.mean()[detection.object].inverse();
      mean.push_back(inverse * prior.mean()[kCamera]);
      to_object.push_back(inverse.adjoint());
      objects.push_back(detection.object);
    }
    cross = times_d_transposed(prior.covariance());
    covariance.resize(size(), size());
    for (std::size_t j = 0; j < objects.size(); ++j) {
      covariance.template middleRows<kPoseDof>(offset(j)).noalias() =
          to_object[j] * (cross.template middleRows<kPoseDof>(offset(kCamera)) -
                          cross.template middleRows<kPoseDof>(offset(objects[j])));
    }
    symmetrize(covariance);
  }

  Index size() const { return offset(objects.size()); }

  /// matrix D^T
  Eigen::Matrix<double, Eigen::Dynamic, Dim> times_d_transposed(const MatrixXd& matrix) const {
    Eigen::Matrix<double, Eigen::Dynamic, Dim> result(matrix.rows(), size());
    for (std::size_t j = 0; j < objects.size(); ++j) {
      result.template middleCols<kPoseDof>(offset(j)).noalias() =
          (matrix.middleCols<kPoseDof>(offset(kCamera)) -
           matrix.middleCols<kPoseDof>(offset(objects[j]))) *
          to_object[j].transpose();
    }
    return result;
  }
};

/// Detection noise n_j = Log(Z_j Y_j offset^-1) at given relative poses, and its covariance, pose
/// by pose.
struct Residual {
  Vector6d n;
  Matrix6d noise;

  Residual(const SE3d& relative, const Detection& detection, const NoiseComponent& component)
      : n((relative * detection.camera_object * component.offset.inverse()).log()) {
    const bool in_camera = component.frame == NoiseFrame::camera;
    const SE3d axes =
        in_camera ? SE3d(relative.rotation(), component.offset.translation()) : component.offset;
    noise = axes.adjoint_congruence(component.covariance);
  }

  double squared_norm() const { return n.dot(Eigen::LLT<Matrix6d>(noise).solve(n)); }
};

/// The solution of the Gauss-Newton iteration.
template <int Dim>
struct RelativePosterior {
  Vector<Dim> zeta;        ///< of the solution, in the tangent space at the prior mean
  Square<Dim> covariance;  ///< there
  double log_likelihood;
  bool ok;
};

/// Gauss-Newton on |zeta|^2_P + |n|^2_R over the relative poses.
template <int Dim>
class RelativeEstimator {
 public:
  RelativeEstimator(const RelativePrior<Dim>& prior, std::span<const Detection> detections,
                    std::span<const NoiseComponent* const> components)
      : prior_(prior),
        detections_(detections),
        components_(components),
        prior_factor_(prior.covariance),
        at_{prior.mean, Vector<Dim>::Zero(prior.size()), 0.0} {
    at_.cost = cost_of(at_);
  }

  RelativePosterior<Dim> solve(const IteratedUpdateSettings& settings) {
    if (prior_factor_.info() != Eigen::Success || !linearize()) return failure();
    for (int iteration = 0; iteration < settings.max_iterations; ++iteration) {
      // delta = -zeta - K (n - H zeta), shortened until the cost does not rise.
      Vector<Dim> step = -at_.zeta - gain_ * (n_ - h_ * at_.zeta);
      Iterate next = moved(step);
      for (int half = 0; half < 8 && next.cost > at_.cost * (1.0 + 1e-12); ++half) {
        step *= 0.5;
        next = moved(step);
      }
      at_ = std::move(next);
      if (!linearize()) return failure();
      if (step.norm() < settings.tolerance) break;
    }
    return {
        at_.zeta, posterior_covariance(),
        -0.5 * (at_.cost + log_det(innovation_) + static_cast<double>(prior_.size()) * kLogTwoPi),
        true};
  }

 private:
  struct Iterate {
    std::vector<SE3d> z;
    Vector<Dim> zeta;  ///< Log(Z mean^-1)
    double cost;       ///< zeta^T P^-1 zeta + n^T R^-1 n
  };

  RelativePosterior<Dim> failure() const {
    return {at_.zeta, prior_.covariance, -std::numeric_limits<double>::infinity(), false};
  }

  /// n, H, R and K at the current iterate; false when the innovation covariance is not positive
  /// definite.
  bool linearize() {
    const Index size = prior_.size();
    n_.resize(size);
    h_ = noise_ = chart_ = Square<Dim>::Zero(size, size);
    for (std::size_t j = 0; j < at_.z.size(); ++j) {
      const Residual residual(at_.z[j], detections_[j], *components_[j]);
      const Index o = offset(j);
      n_.template segment<kPoseDof>(o) = residual.n;
      noise_.template block<kPoseDof, kPoseDof>(o, o) = residual.noise;
      h_.template block<kPoseDof, kPoseDof>(o, o) = SE3d::left_jacobian_inverse(residual.n);
      chart_.template block<kPoseDof, kPoseDof>(o, o) =
          SE3d::left_jacobian(at_.zeta.template segment<kPoseDof>(o));
    }
    here_.noalias() = chart_ * prior_.covariance * chart_.transpose();
    const Square<Dim> p_ht = here_ * h_.transpose();
    Square<Dim> s = h_ * p_ht + noise_;
    symmetrize(s);
    innovation_.compute(s);
    if (innovation_.info() != Eigen::Success) return false;
    gain_ = innovation_.solve(p_ht.transpose()).transpose();
    return true;
  }

  Iterate moved(const Vector<Dim>& step) const {
    Iterate next{at_.z, at_.zeta, 0.0};
    for (std::size_t j = 0; j < next.z.size(); ++j) {
      next.z[j] = SE3d::exp(step.template segment<kPoseDof>(offset(j))) * next.z[j];
      next.zeta.template segment<kPoseDof>(offset(j)) =
          (next.z[j] * prior_.mean[j].inverse()).log();
    }
    next.cost = cost_of(next);
    return next;
  }

  double cost_of(const Iterate& iterate) const {
    double cost = prior_factor_.matrixL().solve(iterate.zeta).squaredNorm();
    for (std::size_t j = 0; j < iterate.z.size(); ++j) {
      cost += Residual(iterate.z[j], detections_[j], *components_[j]).squared_norm();
    }
    return cost;
  }

  /// Joseph's form at the solution, carried back to the tangent space at the prior mean.
  Square<Dim> posterior_covariance() const {
    const Square<Dim> rest = Square<Dim>::Identity(prior_.size(), prior_.size()) - gain_ * h_;
    const Square<Dim> at_solution =
        rest * here_ * rest.transpose() + gain_ * noise_ * gain_.transpose();
    const Eigen::PartialPivLU<Square<Dim>> chart(chart_);
    Square<Dim> covariance = chart.solve(Square<Dim>(chart.solve(at_solution).transpose()));
    symmetrize(covariance);
    return covariance;
  }

  const RelativePrior<Dim>& prior_;
  std::span<const Detection> detections_;
  std::span<const NoiseComponent* const> components_;
  Eigen::LLT<Square<Dim>> prior_factor_;
  Iterate at_;
  Vector<Dim> n_;
  Square<Dim> h_;      ///< J_l^-1(n_j), block by block
  Square<Dim> noise_;  ///< R, block by block
  Square<Dim> chart_;  ///< J_l(zeta_j), block by block
  Square<Dim> here_;   ///< prior covariance in the tangent space at the iterate
  Square<Dim> gain_;
  Eigen::LLT<Square<Dim>> innovation_;
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

template <int Dim>
UpdateResult update_in_relative_poses(const Hypothesis& prior,
                                      std::span<const Detection> detections,
                                      std::span<const NoiseComponent* const> noise,
                                      std::size_t first_object,
                                      const IteratedUpdateSettings& settings) {
  // The relative poses that are seen.
  const RelativePrior<Dim> relative(prior, detections);
  const RelativePosterior<Dim> solution =
      RelativeEstimator<Dim>(relative, detections, noise).solve(settings);
  if (!solution.ok) return {prior, solution.log_likelihood, false};

  // Everything else by regression on them: xi = G zeta, P <- (I - G D) P (I - G D)^T + G S G^T.
  const Eigen::LLT<Square<Dim>> factor(relative.covariance);
  const Eigen::Matrix<double, Eigen::Dynamic, Dim> g =
      factor.solve(relative.cross.transpose()).transpose();
  MatrixXd covariance = prior.covariance();
  covariance.noalias() -= g * relative.cross.transpose();
  const Eigen::Matrix<double, Eigen::Dynamic, Dim> rest =
      g * solution.covariance - relative.times_d_transposed(covariance);
  covariance.noalias() += rest * g.transpose();

  const std::size_t anchor = detections.front().object;
  return {back_project_relative(prior.mean(), g * solution.zeta, std::move(covariance),
                                parents(prior.mean().size(), detections, first_object), anchor),
          solution.log_likelihood, true};
}

}  // namespace

UpdateResult iterated_update(const Hypothesis& prior, std::span<const Detection> detections,
                             std::span<const NoiseComponent* const> noise, std::size_t first_object,
                             const IteratedUpdateSettings& settings) {
  if (detections.empty()) return {prior, 0.0, true};
  if (detections.size() == 1) {
    return update_in_relative_poses<6>(prior, detections, noise, first_object, settings);
  }
  return update_in_relative_poses<Eigen::Dynamic>(prior, detections, noise, first_object, settings);
}

}  // namespace posemix
