// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "quadrature_points.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "posemix/base/error.hpp"
#include "posemix/base/gaussian_cubature.hpp"

namespace posemix::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Points of a standard normal vector in three dimensions and their weights.
struct NormalRule {
  std::vector<Vector3d> points;
  std::vector<double> weights;

  void add(const Vector3d& point, double weight) {
    points.push_back(point);
    weights.push_back(weight);
  }
};

/// Nodes are the eigenvalues of the Jacobi matrix of the Hermite polynomials, weights the squared
/// first entries of its eigenvectors (Golub and Welsch 1969).
NormalRule hermite_product() {
  constexpr int kNodes = 11;
  constexpr double kNegligible = 1e-12;
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(kNodes, kNodes);
  for (int i = 1; i < kNodes; ++i) jacobi(i, i - 1) = std::sqrt(i);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(jacobi);
  const Eigen::VectorXd& x = eigen.eigenvalues();
  const Eigen::VectorXd w = eigen.eigenvectors().row(0).cwiseAbs2();
  NormalRule rule;
  for (int i = 0; i < kNodes; ++i) {
    for (int j = 0; j < kNodes; ++j) {
      for (int k = 0; k < kNodes; ++k) {
        const double weight = w[i] * w[j] * w[k];
        if (weight > kNegligible) rule.add({x[i], x[j], x[k]}, weight);
      }
    }
  }
  return rule;
}

const NormalRule& normal_rule(PointRule rule) {
  static const NormalRule few = [] {
    const auto icosahedron = GaussianCubature<3>::icosahedron();
    NormalRule points;
    for (Eigen::Index i = 0; i < icosahedron.weights.size(); ++i) {
      points.add(icosahedron.points.col(i), icosahedron.weights[i]);
    }
    return points;
  }();
  static const NormalRule many = hermite_product();
  return rule == PointRule::cubature ? few : many;
}

/// The regression of the last three of six Gaussian coordinates on the first three.
struct Regression {
  Matrix3d gain;
  Matrix3d spread;  ///< square root of the residual covariance

  explicit Regression(const Matrix6d& covariance) {
    const Matrix3d cross = covariance.bottomLeftCorner<3, 3>();
    const Eigen::LLT<Matrix3d> factor(Matrix3d(covariance.topLeftCorner<3, 3>()));
    gain = factor.solve(cross.transpose()).transpose();
    const Matrix3d left = covariance.bottomRightCorner<3, 3>() - gain * cross.transpose();
    spread = left.llt().matrixL();
  }
};

/// Calls visit(offset, weight) at the six points of the third-degree rule.
template <class Visit>
void for_each_offset(const Matrix3d& spread, Visit&& visit) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double radius : {std::numbers::sqrt3, -std::numbers::sqrt3}) {
      visit(Vector3d(radius * spread.col(axis)), 1.0 / 6.0);
    }
  }
}

template <RotationOrPose G>
void normalize(QuadraturePoints<G>& points) {
  double sum = 0.0;
  for (const double weight : points.weights) sum += weight;
  require(sum > 0.0,
          "conversion: no point of the density is within 150 deg of its centre, "
          "expected a narrower one");
  for (double& weight : points.weights) weight /= sum;
}

Matrix3d rotation_factor(const Matrix3d& covariance) { return covariance.llt().matrixL(); }

}  // namespace

template <RotationOrPose G>
QuadraturePoints<G> quadrature_points(const TangentGaussian<G>& density, PointRule rule) {
  const NormalRule& normal = normal_rule(rule);
  const G back = density.anchor.inverse();
  const typename G::TangentMatrix body = back.adjoint_congruence(density.covariance);
  const typename G::Tangent mean = back.adjoint() * density.mean;
  const Matrix3d root = rotation_factor(body.template topLeftCorner<3, 3>());
  const Vector3d centre = mean.template head<3>();
  const SO3d centre_back = SO3d::exp(-centre);
  QuadraturePoints<G> points;
  const auto add = [&](const typename G::Tangent& xi, double weight) {
    points.elements.push_back(density.anchor * G::exp(xi));
    points.weights.push_back(weight);
  };
  for (std::size_t i = 0; i < normal.points.size(); ++i) {
    const Vector3d offset_phi = root * normal.points[i];
    const Vector3d phi = centre + offset_phi;
    if (phi.norm() > std::numbers::pi || (centre_back * SO3d::exp(phi)).angle() > kReach) continue;
    if constexpr (std::same_as<G, SE3d>) {
      const Regression rho(body);
      const Vector3d middle = mean.template tail<3>() + rho.gain * offset_phi;
      for_each_offset(rho.spread, [&](const Vector3d& offset, double share) {
        add((Vector6d() << phi, middle + offset).finished(), share * normal.weights[i]);
      });
    } else {
      add(phi, normal.weights[i]);
    }
  }
  normalize(points);
  return points;
}

template <RotationOrPose G>
QuadraturePoints<G> quadrature_points(const ProjectedGaussian<G>& density, PointRule rule) {
  const NormalRule& normal = normal_rule(rule);
  const bool by_moments = rule == PointRule::cubature;
  const DistributionMoments<G> distribution = moments_of(density);
  const typename G::Tangent mean = by_moments ? distribution.mean : density.tangent_mean();
  const typename G::TangentMatrix covariance =
      by_moments ? distribution.covariance : density.covariance();
  const Matrix3d root = rotation_factor(covariance.template topLeftCorner<3, 3>());
  QuadraturePoints<G> points;
  const auto add = [&](const typename G::Tangent& y, double weight) {
    points.elements.push_back(density.element(y));
    points.weights.push_back(weight);
  };
  for (std::size_t i = 0; i < normal.points.size(); ++i) {
    const Vector3d offset_u = root * normal.points[i];
    const Vector3d u = mean.template head<3>() + offset_u;
    // The ratio of the distribution to the Gaussian in the tangent space is proportional to (1 +
    // u.u)^-2.
    const double weight =
        normal.weights[i] * (by_moments ? 1.0 : std::pow(1.0 + u.squaredNorm(), -2));
    if constexpr (std::same_as<G, SE3d>) {
      const Regression t(covariance);
      const Vector3d centre = mean.template tail<3>() + t.gain * offset_u;
      for_each_offset(t.spread, [&](const Vector3d& offset, double share) {
        add((Vector6d() << u, centre + offset).finished(), share * weight);
      });
    } else {
      add(u, weight);
    }
  }
  normalize(points);
  return points;
}

template QuadraturePoints<SO3d> quadrature_points(const TangentGaussian<SO3d>&, PointRule);
template QuadraturePoints<SO3d> quadrature_points(const ProjectedGaussian<SO3d>&, PointRule);
template QuadraturePoints<SE3d> quadrature_points(const TangentGaussian<SE3d>&, PointRule);
template QuadraturePoints<SE3d> quadrature_points(const ProjectedGaussian<SE3d>&, PointRule);

}  // namespace posemix::internal
