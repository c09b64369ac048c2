// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/density/projected_operations.hpp"
#include "posemix/lie/rotation_of.hpp"

namespace posemix {
namespace {

/// One factor of the product: its cost (y - mean)^T P^-1 (y - mean) / 2 as a function of the
/// element, with derivatives in the chart at the element.
template <RotationOrPose G>
class Factor {
 public:
  using Tangent = typename G::Tangent;
  using Matrix = typename G::TangentMatrix;

  explicit Factor(const ProjectedGaussian<G>& density)
      : density_(&density), factor_(density.covariance()) {}

  /// log of N(0; 0, P) / C.
  double log_peak() const {
    return -0.5 * (log_det(factor_) + G::Dof * kLogTwoPi) - density_->log_normalizer();
  }

  Tangent residual(const G& at) const {
    return density_->coordinates(at) - density_->tangent_mean();
  }
  double cost(const G& at) const {
    return 0.5 * factor_.matrixL().solve(residual(at)).squaredNorm();
  }
  /// Whether a quaternion is on the tangent point's side of the equator.
  bool side(const Eigen::Quaterniond& q) const {
    return density_->tangent_point().quaternion().dot(q) >= 0.0;
  }

  void add_derivatives(const G& at, Tangent& gradient, Matrix& gauss_newton,
                       Matrix& second_order) const {
    const gnomonic::ChartChange f(rotation_of(at), density_->tangent_point());
    Matrix j = Matrix::Identity();
    j.template topLeftCorner<3, 3>() = f.jacobian(Eigen::Vector3d::Zero());
    const Tangent pull = factor_.solve(residual(at));
    gradient += j.transpose() * pull;
    gauss_newton += j.transpose() * factor_.solve(j);
    second_order.template topLeftCorner<3, 3>() +=
        f.second_derivative(Eigen::Vector3d::Zero(), pull.template head<3>());
  }

 private:
  const ProjectedGaussian<G>* density_;
  Eigen::LLT<Matrix> factor_;
};

/// Newton's method for one mode of the product; no step crosses an equator.
template <RotationOrPose G>
class ModeSearch {
 public:
  using Tangent = typename G::Tangent;
  using Matrix = typename G::TangentMatrix;

  ModeSearch(const Factor<G>& p, const Factor<G>& q, const G& start,
             const ProjectedFuseSettings& settings)
      : p_(p), q_(q), mode_(start) {
    same_side_ = sides_agree(mode_);
    const double tolerance =
        std::max(settings.tolerance,
                 16.0 * std::numeric_limits<double>::epsilon() * (1.0 + translation_norm(start)));
    double cost = this->cost(mode_);
    for (; iterations < settings.max_iterations && !converged; ++iterations) {
      const Tangent step = newton_step();
      converged = step.norm() < tolerance;
      if (!advance(step, cost)) {
        converged = converged || step.norm() < std::sqrt(tolerance);
        break;
      }
    }
    newton_step();  // computes the information at the mode
  }

  /// The mode as a density, and the log of the product's integral there over the group.
  ProductMode<G> mode() const {
    Matrix covariance = information_.solve(Matrix::Identity());
    symmetrize(covariance);
    const ProjectedGaussian<G> density = ProjectedGaussian<G>::trusted(mode_, covariance);
    const double log_overlap = p_.log_peak() + q_.log_peak() - cost(mode_) +
                               0.5 * (G::Dof * kLogTwoPi - log_det(information_)) +
                               density.log_normalizer() - gnomonic::kLogHaarPerHalfSphere;
    return {density, log_overlap};
  }

  bool converged = false;
  int iterations = 0;

 private:
  double cost(const G& at) const { return p_.cost(at) + q_.cost(at); }
  bool sides_agree(const G& at) const {
    const Eigen::Quaterniond& q = rotation_of(at).quaternion();
    return p_.side(q) == q_.side(q);
  }
  static double translation_norm(const SO3d&) { return 0.0; }
  static double translation_norm(const SE3d& pose) { return pose.translation().norm(); }

  /// The Newton step, or the Gauss-Newton step if the Hessian is not positive definite.
  Tangent newton_step() {
    Tangent gradient = Tangent::Zero();
    Matrix gauss_newton = Matrix::Zero();
    Matrix second_order = Matrix::Zero();
    p_.add_derivatives(mode_, gradient, gauss_newton, second_order);
    q_.add_derivatives(mode_, gradient, gauss_newton, second_order);
    information_.compute(gauss_newton + second_order);
    if (information_.info() != Eigen::Success) {
      converged = false;
      information_.compute(gauss_newton);
    }
    return -information_.solve(gradient);
  }

  /// Takes the largest of the steps 1, 1/2, 1/4, ... that does not raise the cost and crosses no
  /// equator.
  bool advance(const Tangent& step, double& cost) {
    const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * (1.0 + cost);
    for (double part = 1.0; part > 1e-9; part *= 0.5) {
      const G next = moved(part * step);
      const double next_cost = this->cost(next);
      if (sides_agree(next) == same_side_ && next_cost <= cost + rounding) {
        mode_ = next;
        cost = next_cost;
        return true;
      }
    }
    return false;
  }

  G moved(const Tangent& step) const {
    SO3d rotation = gnomonic::project(rotation_of(mode_), step.template head<3>());
    if constexpr (std::same_as<G, SE3d>) {
      return SE3d(rotation, mode_.translation() + step.template tail<3>());
    } else {
      return rotation;
    }
  }

  const Factor<G>& p_;
  const Factor<G>& q_;
  G mode_;
  bool same_side_;
  Eigen::LLT<Matrix> information_;
};

/// The element halfway between two. With `other_way`, halfway along the other arc between their
/// quaternions, by the difference of these instead of the sum.
SO3d halfway(const SO3d& a, const SO3d& b, bool other_way) {
  if (!other_way) return gnomonic::halfway(a, b);
  const double sign = a.quaternion().dot(b.quaternion()) < 0.0 ? -1.0 : 1.0;
  return SO3d::from_quaternion(Eigen::Quaterniond(
      Eigen::Vector4d(a.quaternion().coeffs() - sign * b.quaternion().coeffs())));
}
SE3d halfway(const SE3d& a, const SE3d& b, bool other_way) {
  return SE3d(halfway(a.rotation(), b.rotation(), other_way),
              0.5 * (a.translation() + b.translation()));
}

/// A lower bound on the cost of the second mode. It is on the tangent point's side of one equator
/// but not of the other, so its quaternion is at least (pi - angle) / 2 from one tangent point.
template <RotationOrPose G>
double other_way_cost(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  const double away = std::tan(0.5 * (std::numbers::pi - tangent_angle(p, q)));
  double least = std::numeric_limits<double>::infinity();
  for (const auto* density : {&p, &q}) {
    const double u = std::max(0.0, away - density->tangent_mean().template head<3>().norm());
    const double spread = density->covariance().template topLeftCorner<3, 3>().trace();
    least = std::min(least, 0.5 * u * u / spread);
  }
  return least;
}

template <RotationOrPose G>
ProjectedFusion<G> fuse_at_mode(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q,
                                const ProjectedFuseSettings& settings) {
  const Factor<G> from_p(p), from_q(q);
  const ModeSearch<G> first(from_p, from_q, halfway(p.mean(), q.mean(), false), settings);
  const ProductMode<G> mode = first.mode();
  ProjectedFusion<G> fusion{mode.density, mode.log_overlap, first.converged, first.iterations, {}};

  // An upper bound of the second mode: exp(-cost) times pi^2, the volume of the half sphere.
  const double most = from_p.log_peak() + from_q.log_peak() - other_way_cost(p, q) +
                      2.0 * std::log(std::numbers::pi) - gnomonic::kLogHaarPerHalfSphere;
  double translation_volume = 0.0;
  if constexpr (std::same_as<G, SE3d>) {
    const Eigen::Matrix3d sum = mode.density.covariance().template bottomRightCorner<3, 3>();
    translation_volume = 1.5 * kLogTwoPi + 0.5 * log_det(Eigen::LLT<Eigen::Matrix3d>(sum));
  }
  constexpr double kMargin = 3.0;
  const double least = mode.log_overlap + std::log(settings.second_mode_from);
  if (most + translation_volume + kMargin < least || tangent_angle(p, q) < 1e-6) return fusion;
  const ModeSearch<G> second(from_p, from_q, halfway(p.mean(), q.mean(), true), settings);
  ProductMode<G> other = second.mode();
  if (second.converged && other.log_overlap >= least) fusion.second = other;
  if (fusion.second && other.log_overlap > fusion.log_overlap) {
    fusion.second = mode;
    fusion.density = other.density;
    fusion.log_overlap = other.log_overlap;
  }
  return fusion;
}

/// Eq. 14-16: both densities are moved to the chart at q3 = (q1 + q2) / |q1 + q2| and fused there,
/// and the product is moved to the chart at its mode.
template <RotationOrPose G>
ProjectedFusion<G> fuse_by_jacobian(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q,
                                    const ProjectedFuseSettings& settings) {
  const double angle = tangent_angle(p, q);
  if (!(angle <= settings.max_angle)) {
    throw InvalidInput(fmt::format(
        "fuse: the quaternions of the tangent points are {:.4g} degrees apart, the Jacobian rule "
        "allows {:.4g}",
        degrees(angle), degrees(settings.max_angle)));
  }
  using Matrix = typename G::TangentMatrix;
  const SO3d q3 = gnomonic::halfway(p.tangent_point(), q.tangent_point());
  const ProjectedGaussian<G> p3 = change_chart(p, q3);
  const ProjectedGaussian<G> r3 = change_chart(q, q3);
  const Eigen::LLT<Matrix> sum(p3.covariance() + r3.covariance());
  const typename G::Tangent apart = r3.tangent_mean() - p3.tangent_mean();
  const Matrix gain = sum.solve(p3.covariance()).transpose();
  Matrix covariance = gain * r3.covariance();
  symmetrize(covariance);
  const auto fused = ProjectedGaussian<G>::trusted(
      q3, typename G::Tangent(p3.tangent_mean() + gain * apart), covariance);

  const auto log_jacobian = [&](const ProjectedGaussian<G>& density) {
    const gnomonic::ChartChange f(density.tangent_point(), q3);
    return f.log_det_jacobian(density.tangent_mean().template head<3>());
  };
  const double log_overlap = log_normal(sum, apart) + log_jacobian(p) + log_jacobian(q) +
                             fused.log_normalizer() - p.log_normalizer() - q.log_normalizer() -
                             gnomonic::kLogHaarPerHalfSphere;
  return {change_chart_to_mode(fused), log_overlap, true, 1, {}};
}

}  // namespace

template <RotationOrPose G>
ProjectedFusion<G> fuse(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q,
                        const ProjectedFuseSettings& settings) {
  require(settings.max_iterations > 0, "fuse: max_iterations must be at least 1");
  require(settings.second_mode_from > 0.0, "fuse: second_mode_from must be positive");
  if (settings.rule == FusionRule::jacobian) return fuse_by_jacobian(p, q, settings);
  return fuse_at_mode(p, q, settings);
}

template ProjectedFusion<SO3d> fuse(const ProjectedGaussian<SO3d>&, const ProjectedGaussian<SO3d>&,
                                    const ProjectedFuseSettings&);
template ProjectedFusion<SE3d> fuse(const ProjectedGaussian<SE3d>&, const ProjectedGaussian<SE3d>&,
                                    const ProjectedFuseSettings&);

}  // namespace posemix
