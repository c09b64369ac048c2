// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "density_fit.hpp"

#include <cmath>

#include "posemix/lie/rotation_of.hpp"
#include "posemix/mixture/projected_mixture.hpp"

namespace posemix::internal {
namespace {

using Eigen::Vector3d;

constexpr int kIterations = 50;
constexpr double kTolerance = 1e-10;

/// The gradient of log |det J_l| with respect to the rotation vector is this factor times the
/// rotation vector: (cot(a/2) - 2/a) / a for the angle a, from log |det J_l| = log(2 sin(a/2) /
/// a)^2.
double log_volume_slope(double angle) {
  if (angle < 0.02) return -1.0 / 6.0 - angle * angle / 360.0;
  return (1.0 / std::tan(0.5 * angle) - 2.0 / angle) / angle;
}

/// The points relative to the mean M of a concentrated Gaussian, X = M Exp(xi), and the negative
/// mean log-likelihood under the best covariance for this mean, up to a constant.
template <RotationOrPose G>
struct BodyView {
  using Tangent = typename G::Tangent;
  using Covariance = typename G::TangentMatrix;
  static constexpr int kVolumes = G::Dof / 3;  ///< |det J_l| is this power of its value on SO(3)

  Tangent mean = Tangent::Zero();
  Covariance moment = Covariance::Zero();
  double cost = 0.0;

  BodyView(const QuadraturePoints<G>& points, const G& at) : points_(&points), back_(at.inverse()) {
    for (std::size_t i = 0; i < points.elements.size(); ++i) {
      const Tangent xi = (back_ * points.elements[i]).log();
      mean += points.weights[i] * xi;
      moment += points.weights[i] * xi * xi.transpose();
      cost += points.weights[i] * G::log_abs_det_left_jacobian(xi);
    }
    symmetrize(moment);
    cost += 0.5 * log_det(Eigen::LLT<Covariance>(moment));
  }

  /// The Gauss-Newton step of the mean: moving M to M Exp(d) moves xi to xi - J_l^-1(xi) d; in the
  /// Hessian, J_l = I.
  Tangent newton_step() const {
    const Eigen::LLT<Covariance> factor(moment);
    Tangent gradient = Tangent::Zero();
    for (std::size_t i = 0; i < points_->elements.size(); ++i) {
      const Tangent xi = (back_ * points_->elements[i]).log();
      Tangent slope = factor.solve(xi);
      const Vector3d phi = xi.template head<3>();
      slope.template head<3>() += kVolumes * log_volume_slope(phi.norm()) * phi;
      gradient += points_->weights[i] * (G::left_jacobian_inverse(xi).transpose() * slope);
    }
    return moment * gradient;
  }

 private:
  const QuadraturePoints<G>* points_;
  G back_;
};

/// Damped iteration: `view.newton_step()` is taken whole or halved until the cost falls. True if it
/// converged.
template <class View, class Element, class Look, class Move>
bool descend(View& view, Element& at, Look&& look, Move&& move) {
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const auto step = view.newton_step();
    if (step.norm() < kTolerance) return true;
    bool fell = false;
    for (double share = 1.0; share > 1e-3 && !fell; share *= 0.5) {
      const Element next = move(at, share * step);
      const View there = look(next);
      fell = there.cost < view.cost;
      if (!fell) continue;
      at = next;
      view = there;
    }
    // The cost no longer falls because of rounding.
    if (!fell) return step.norm() < 1e3 * std::sqrt(kTolerance);
  }
  return false;
}

/// The points in the chart at a tangent point, and the negative mean log-likelihood of the best
/// density with this tangent point, up to a constant.
template <RotationOrPose G>
struct ChartView {
  ProjectedGaussian<G> density;
  double cost;

  ChartView(const QuadraturePoints<G>& points, const SO3d& tangent_point)
      : ChartView(points, tangent_point, moments_at(points, tangent_point)) {}

  /// The Gauss-Newton step of the tangent point: moving it by d moves u by -(I + u u^T) d + u x d.
  Vector3d newton_step() const {
    using Tangent = typename G::Tangent;
    const Eigen::LLT<typename G::TangentMatrix> factor(density.covariance());
    Vector3d gradient = Vector3d::Zero();
    Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
    const Eigen::Matrix3d information =
        factor.solve(G::TangentMatrix::Identity()).template topLeftCorner<3, 3>();
    for (std::size_t i = 0; i < points_->elements.size(); ++i) {
      const Tangent y = density.coordinates(points_->elements[i]);
      const Vector3d u = y.template head<3>();
      const Vector3d slope = factor.solve(Tangent(y - density.tangent_mean())).template head<3>();
      const Eigen::Matrix3d move = Eigen::Matrix3d::Identity() + u * u.transpose() - SO3d::hat(u);
      gradient += points_->weights[i] * move.transpose() * slope;
      curvature += points_->weights[i] * move.transpose() * information * move;
    }
    return curvature.llt().solve(gradient);
  }

 private:
  struct ChartMoments {
    typename G::Tangent mean = G::Tangent::Zero();
    typename G::TangentMatrix covariance = G::TangentMatrix::Zero();  ///< about zero in u
  };

  static ChartMoments moments_at(const QuadraturePoints<G>& points, const SO3d& tangent_point) {
    const auto chart = ProjectedGaussian<G>::trusted(tangent_point, G::Tangent::Zero(),
                                                     G::TangentMatrix::Identity());
    typename G::Tangent mean = G::Tangent::Zero();
    typename G::TangentMatrix second = G::TangentMatrix::Zero();
    for (std::size_t i = 0; i < points.elements.size(); ++i) {
      const typename G::Tangent y = chart.coordinates(points.elements[i]);
      mean += points.weights[i] * y;
      second += points.weights[i] * y * y.transpose();
    }
    ChartMoments result;
    if constexpr (std::same_as<G, SE3d>) {
      // The mean of the regression t = t0 + B u is taken at u = 0, which need not be the mean of u.
      const typename G::TangentMatrix about_mean = second - mean * mean.transpose();
      const Eigen::Matrix3d of_u = about_mean.template topLeftCorner<3, 3>();
      const Eigen::Matrix3d cross = about_mean.template bottomLeftCorner<3, 3>();
      const Eigen::Matrix3d gain = of_u.llt().solve(cross.transpose()).transpose();
      const Eigen::Matrix3d moment = second.template topLeftCorner<3, 3>();
      const Eigen::Matrix3d left =
          about_mean.template bottomRightCorner<3, 3>() - gain * cross.transpose();
      result.mean.template tail<3>() =
          mean.template tail<3>() - gain * Vector3d(mean.template head<3>());
      result.covariance << moment, moment * gain.transpose(), gain * moment,
          left + gain * moment * gain.transpose();
    } else {
      result.covariance = second;
    }
    symmetrize(result.covariance);
    return result;
  }

  ChartView(const QuadraturePoints<G>& points, const SO3d& tangent_point,
            const ChartMoments& moments)
      : density(with_moments<G>(tangent_point, moments.mean, moments.covariance)),
        points_(&points) {
    const Eigen::LLT<typename G::TangentMatrix> factor(density.covariance());
    cost = 0.5 * log_det(factor) + density.log_normalizer() +
           0.5 * factor.solve(moments.covariance).trace();
  }

  const QuadraturePoints<G>* points_;
};

}  // namespace

template <RotationOrPose G>
ConvertedDensity<ConcentratedGaussian<G>> fit_concentrated(const QuadraturePoints<G>& points,
                                                           bool most_likely) {
  const MeanResult<G> start = weighted_mean<G>(points.elements, points.weights);
  G mean = start.mean;
  BodyView<G> view(points, mean);
  bool converged = start.converged;
  if (most_likely) {
    converged = descend(
        view, mean, [&](const G& at) { return BodyView<G>(points, at); },
        [](const G& at, const typename G::Tangent& step) { return at * G::exp(step); });
  }
  typename G::TangentMatrix covariance = mean.adjoint_congruence(view.moment);
  symmetrize(covariance);
  return {ConcentratedGaussian<G>::trusted(mean, covariance), converged};
}

template <RotationOrPose G>
ConvertedDensity<ProjectedGaussian<G>> fit_projected(const QuadraturePoints<G>& points,
                                                     bool most_likely) {
  std::vector<SO3d> rotations;
  rotations.reserve(points.elements.size());
  for (const G& element : points.elements) rotations.push_back(rotation_of(element));
  const MeanResult<SO3d> start = gnomonic_mean(rotations, points.weights);
  SO3d tangent_point = start.mean;
  ChartView<G> view(points, tangent_point);
  bool converged = start.converged;
  if (most_likely) {
    converged = descend(
        view, tangent_point, [&](const SO3d& at) { return ChartView<G>(points, at); },
        [](const SO3d& at, const Vector3d& step) { return gnomonic::project(at, step); });
  }
  return {view.density, converged};
}

template ConvertedDensity<ConcentratedGaussian<SO3d>> fit_concentrated(
    const QuadraturePoints<SO3d>&, bool);
template ConvertedDensity<ProjectedGaussian<SO3d>> fit_projected(const QuadraturePoints<SO3d>&,
                                                                 bool);
template ConvertedDensity<ConcentratedGaussian<SE3d>> fit_concentrated(
    const QuadraturePoints<SE3d>&, bool);
template ConvertedDensity<ProjectedGaussian<SE3d>> fit_projected(const QuadraturePoints<SE3d>&,
                                                                 bool);

}  // namespace posemix::internal
