// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em_projected.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "posemix/lie/mean.hpp"
#include "posemix/lie/rotation_of.hpp"

namespace posemix {
namespace {

/// Writes the translation of an element, if it has one, to the entries of y after u.
void put_translation(const SO3d&, SO3d::Tangent&) {}
void put_translation(const SE3d& element, SE3d::Tangent& y) { y.tail<3>() = element.translation(); }

/// The result of the regression t = a + B u + e.
struct Regression {
  Eigen::Vector3d intercept;
  Eigen::Matrix3d slope;
  Eigen::Matrix3d residual;  ///< covariance of e, within bounds
};

EmSettings of_translation(const EmSettings& settings) {
  EmSettings result = settings;
  if (settings.unit.size() != 0) result.unit = settings.unit.tail<3>().eval();
  return result;
}

Regression regress(const Vector6d& first, const Matrix6d& second, const EmSettings& settings) {
  const Vector6d mean = settings.fixed_means ? Vector6d(Vector6d::Zero()) : first;
  const Matrix6d about = second - mean * mean.transpose();
  Regression fit{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero(), about.bottomRightCorner<3, 3>()};
  if (!settings.diagonal) {
    Eigen::Matrix3d uu = about.topLeftCorner<3, 3>();
    constexpr double kRidge = 1e-14;  // for samples that do not span three dimensions
    uu.diagonal() +=
        kRidge * (uu.diagonal() + Eigen::Vector3d::Constant(std::pow(settings.min_sd, 2)));
    fit.slope = uu.ldlt().solve(about.topRightCorner<3, 3>()).transpose();
    fit.residual -= fit.slope * about.topRightCorner<3, 3>();
    symmetrize(fit.residual);
  }
  if (!settings.fixed_means) fit.intercept = first.tail<3>() - fit.slope * first.head<3>();
  fit.residual = bounded_covariance(fit.residual, of_translation(settings));
  return fit;
}

/// The covariance of t given u.
Eigen::Matrix3d covariance_given_u(const Matrix6d& p) {
  const Eigen::Matrix3d uu = p.topLeftCorner<3, 3>();
  return p.bottomRightCorner<3, 3>() -
         p.bottomLeftCorner<3, 3>() * uu.llt().solve(p.topRightCorner<3, 3>());
}

/// A covariance of y = [u; t] whose P_uu and R are within the bounds.
Eigen::Matrix3d within_bounds(const Eigen::Matrix3d& p, const EmSettings& settings) {
  return internal::clipped_projected_covariance(p, settings);
}
Matrix6d within_bounds(const Matrix6d& p, const EmSettings& settings) {
  const Eigen::Matrix3d uu =
      internal::clipped_projected_covariance(p.topLeftCorner<3, 3>(), settings);
  const Eigen::Matrix3d given = covariance_given_u(p);
  const Eigen::Matrix3d r = bounded_covariance(given, of_translation(settings));
  if (uu == p.topLeftCorner<3, 3>() && r == given) return p;
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
  if (!settings.diagonal)
    slope = p.topLeftCorner<3, 3>().llt().solve(p.topRightCorner<3, 3>()).transpose();
  Matrix6d result;
  result.topLeftCorner<3, 3>() = uu;
  result.bottomLeftCorner<3, 3>() = slope * uu;
  result.topRightCorner<3, 3>() = result.bottomLeftCorner<3, 3>().transpose();
  result.bottomRightCorner<3, 3>() = r + slope * uu * slope.transpose();
  symmetrize(result);
  return result;
}

/// The projected Gaussian of largest likelihood at a tangent point for moments of y = [u; t - a].
ProjectedGaussian<SO3d> fit_at(const SO3d& tangent_point, const SO3d::Tangent&,
                               const SO3d::Tangent&, const Eigen::Matrix3d& second,
                               const EmSettings& settings) {
  return ProjectedGaussian<SO3d>::trusted(tangent_point, Eigen::Vector3d::Zero(),
                                          internal::bounded_projected_covariance(second, settings));
}

ProjectedGaussian<SE3d> fit_at(const SO3d& tangent_point, const Vector6d& centre,
                               const Vector6d& first, const Matrix6d& second,
                               const EmSettings& settings) {
  const Eigen::Matrix3d uu =
      internal::bounded_projected_covariance(second.topLeftCorner<3, 3>(), settings);
  const Regression t = regress(first, second, settings);
  Vector6d mean = Vector6d::Zero();
  mean.tail<3>() = centre.tail<3>() + t.intercept;
  Matrix6d covariance;
  covariance.topLeftCorner<3, 3>() = uu;
  covariance.bottomLeftCorner<3, 3>() = t.slope * uu;
  covariance.topRightCorner<3, 3>() = (t.slope * uu).transpose();
  covariance.bottomRightCorner<3, 3>() = t.residual + t.slope * uu * t.slope.transpose();
  symmetrize(covariance);
  return ProjectedGaussian<SE3d>::trusted(tangent_point, mean, covariance);
}

/// B^T R^-1 B, the information about u in t.
Eigen::Matrix3d information_from_t(const Eigen::Matrix3d&) { return Eigen::Matrix3d::Zero(); }
Eigen::Matrix3d information_from_t(const Matrix6d& p) {
  const Eigen::Matrix3d uu = p.topLeftCorner<3, 3>();
  const Eigen::Matrix3d slope = uu.llt().solve(p.topRightCorner<3, 3>()).transpose();
  return slope.transpose() * covariance_given_u(p).ldlt().solve(slope);
}

/// The expected negative second derivative with respect to d, per sample, for E[u u^T] = m and
/// E[u.u (u.s)] = `fourth`. Fourth moments are those of a Gaussian, multiplied by the ratio of
/// `fourth` to its value for a Gaussian. In the axes of P_uu the part from u is diagonal; t adds
/// the part from u (u.d) less its linear regression on u.
Eigen::Matrix3d curvature(const Eigen::Matrix3d& uu, const Eigen::Matrix3d& m,
                          const Eigen::Matrix3d& from_t, double fourth) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(uu);
  const Eigen::Matrix3d& axes = eigen.eigenvectors();
  const Eigen::Array3d lambda = eigen.eigenvalues().array().inverse();
  const Eigen::Array3d v = (axes.transpose() * m * axes).diagonal().array();
  const double of_gaussian = v.sum() * (lambda * v).sum() + 2.0 * (lambda * v.square()).sum();
  const double heavy = std::max(0.1, fourth / of_gaussian);
  Eigen::Vector3d h;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Index j = (i + 1) % 3;
    const Eigen::Index k = (i + 2) % 3;
    h[i] = lambda[i] * (1.0 + 4.0 * v[i]) + lambda[j] * v[k] + lambda[k] * v[j] +
           3.0 * heavy * v[i] * (3.0 * lambda[i] * v[i] + lambda[j] * v[j] + lambda[k] * v[k]);
  }
  return axes * h.asDiagonal() * axes.transpose() +
         heavy * ((from_t * m).trace() * m + m * from_t * m);
}

}  // namespace

template <RotationOrPose G>
EmModel<ProjectedGaussian<G>>::Worker::Worker(const Density& density, const EmSettings& settings)
    : density_(density),
      settings_(&settings),
      kernel_(internal::kernel_of(density)),
      rows_(G::Dof) {}

template <RotationOrPose G>
void EmModel<ProjectedGaussian<G>>::Worker::log_density(const Samples& samples, std::size_t begin,
                                                        std::size_t count, EmRow& out) {
  count_ = count;
  internal::projected_log_density(samples.block(begin), count, kernel_, rows_.data(), out);
}

template <RotationOrPose G>
void EmModel<ProjectedGaussian<G>>::Worker::accumulate(const EmRow& shares) {
  internal::add_moments(G::Dof, rows_.data(), shares, count_, sums_.data());
  if (!settings_->fixed_means) {
    internal::add_projected_gradient(rows_.data(), shares, count_, kernel_, gradient_.data());
  }
}

/// The step d of the tangent point, at the P_uu, a, B and R that fit the shares best at the present
/// tangent point: with these, sum r s = W P_uu^-1 E[u], and t contributes only to third moments.
template <RotationOrPose G>
Eigen::Vector3d EmModel<ProjectedGaussian<G>>::Worker::move(const Tangent& first,
                                                            const Covariance& second) const {
  const Density fit =
      fit_at(density_.tangent_point(), density_.tangent_mean(), first, second, *settings_);
  const Eigen::Matrix3d uu = fit.covariance().template topLeftCorner<3, 3>();
  const Eigen::Matrix3d m = second.template topLeftCorner<3, 3>();
  const Eigen::Matrix3d precision = uu.llt().solve(Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d turn = m * precision;
  Eigen::Vector3d gradient = precision * first.template head<3>();
  gradient +=
      Eigen::Vector3d(turn(1, 2) - turn(2, 1), turn(2, 0) - turn(0, 2), turn(0, 1) - turn(1, 0));
  for (std::size_t i = 0; i < 3; ++i)
    gradient[static_cast<Eigen::Index>(i)] += gradient_.total(i) / weight();
  const Eigen::Vector3d d =
      curvature(uu, m, information_from_t(fit.covariance()), gradient_.total(3) / weight())
          .llt()
          .solve(gradient);
  if (!d.allFinite()) return Eigen::Vector3d::Zero();
  return d / std::max(1.0, d.norm());
}

template <RotationOrPose G>
ProjectedGaussian<G> EmModel<ProjectedGaussian<G>>::Worker::update(double step) const {
  constexpr auto n = static_cast<std::size_t>(G::Dof);
  Tangent first;
  Covariance second;
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    first[row] = sums_.total(1 + i) / weight();
    for (std::size_t j = 0; j <= i; ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      second(row, column) = sums_.total(internal::em_second_moment(n, i, j)) / weight();
      second(column, row) = second(row, column);
    }
  }
  SO3d tangent_point = density_.tangent_point();
  if (!settings_->fixed_means && step > 0.0) {
    const Eigen::Vector3d d = step * move(first, second);
    tangent_point = gnomonic::project(tangent_point, d);
    Covariance jacobian = Covariance::Identity();
    jacobian.template topLeftCorner<3, 3>() =
        (Eigen::Matrix3d::Identity() - SO3d::hat(d)) / (1.0 + d.squaredNorm());
    Tangent shift = Tangent::Zero();
    shift.template head<3>() = d;
    second += shift * shift.transpose() - first * shift.transpose() - shift * first.transpose();
    second = (jacobian * second * jacobian.transpose()).eval();
    symmetrize(second);
    first = (jacobian * (first - shift)).eval();
  }
  return fit_at(tangent_point, density_.tangent_mean(), first, second, *settings_);
}

template <RotationOrPose G>
ProjectedGaussian<G> EmModel<ProjectedGaussian<G>>::start(std::span<const G> elements,
                                                          std::span<const double> weights,
                                                          const EmSettings& settings,
                                                          const Density* prior) {
  // |u| at 143 degrees: samples near the equator must not dominate a start.
  constexpr double kFarthest = 3.0;
  SO3d tangent_point;
  if (!settings.fixed_means) {
    std::vector<SO3d> rotations;
    for (const G& element : elements) rotations.push_back(rotation_of(element));
    tangent_point = weighted_mean<SO3d>(rotations, weights, {.max_iterations = 20}).mean;
  }
  double total = 0.0;
  double largest = 0.0;
  Tangent first = Tangent::Zero();
  Covariance second = Covariance::Zero();
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Eigen::Quaterniond r =
        tangent_point.quaternion().conjugate() * rotation_of(elements[i]).quaternion();
    Tangent y;
    y.template head<3>() =
        std::copysign(1.0, r.w()) * r.vec() / std::max(std::abs(r.w()), r.vec().norm() / kFarthest);
    put_translation(elements[i], y);
    first += weights[i] * y;
    second += weights[i] * y * y.transpose();
    total += weights[i];
    largest = std::max(largest, weights[i]);
  }
  Tangent centre = first / total;
  centre.template head<3>().setZero();
  if (settings.fixed_means) centre.setZero();
  second +=
      total * centre * centre.transpose() - first * centre.transpose() - centre * first.transpose();
  first -= total * centre;
  if (prior != nullptr) {  // the prior counts as enough samples to span the tangent space
    const double count = G::Dof * largest;
    second += count * prior->covariance();
    total += count;
  }
  second /= total;
  symmetrize(second);
  return fit_at(tangent_point, centre, Tangent(first / total), second, settings);
}

/// The squared distance of half the rotation vector, in units of the mean spread of u, and of the
/// translations.
template <RotationOrPose G>
double EmModel<ProjectedGaussian<G>>::squared_distance(const Density& density, const G& a,
                                                       const G& b) {
  const Eigen::Vector3d half = 0.5 * (rotation_of(b).inverse() * rotation_of(a)).log();
  const Tangent variance = density.covariance().diagonal();
  double sum = 3.0 * half.squaredNorm() / variance.template head<3>().sum();
  if constexpr (G::Dof == 6) {
    const Eigen::Vector3d t = a.translation() - b.translation();
    sum += (t.array().square() / variance.template tail<3>().array()).sum();
  }
  return sum;
}

template <RotationOrPose G>
ProjectedGaussian<G> EmModel<ProjectedGaussian<G>>::stretched(const Density& density,
                                                              const Eigen::VectorXd& factors) {
  return Density::trusted(
      density.tangent_point(), density.tangent_mean(),
      Covariance(factors.asDiagonal() * density.covariance() * factors.asDiagonal()));
}

template <RotationOrPose G>
std::size_t EmModel<ProjectedGaussian<G>>::parameters(Eigen::Index dof,
                                                      const EmSettings& settings) {
  const auto n = static_cast<std::size_t>(dof);
  return (settings.fixed_means ? 0 : n) + (settings.diagonal ? n : n * (n + 1) / 2);
}

template <RotationOrPose G>
bool EmModel<ProjectedGaussian<G>>::on_lower_bound(const Density& density,
                                                   const EmSettings& settings) {
  Eigen::VectorXd inverse_unit = Eigen::VectorXd::Ones(G::Dof);
  if (settings.unit.size() != 0) inverse_unit = settings.unit.cwiseInverse();
  inverse_unit.head<3>() *= 2.0;
  Eigen::VectorXd variances(G::Dof);
  const auto put = [&](Eigen::Index at, const Eigen::Matrix3d& covariance) {
    const Eigen::Vector3d scale = inverse_unit.segment<3>(at);
    const Eigen::Matrix3d scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
    variances.segment<3>(at) =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scaled, Eigen::EigenvaluesOnly)
            .eigenvalues();
  };
  put(0, density.covariance().template topLeftCorner<3, 3>());
  if constexpr (G::Dof == 6) put(3, covariance_given_u(density.covariance()));
  const double lowest = settings.min_sd * settings.min_sd;
  return variances.minCoeff() <= 1.001 * lowest &&
         (variances.maxCoeff() <= 1.001 * lowest || lowest <= 1e-6 * variances.maxCoeff());
}

template <RotationOrPose G>
ProjectedGaussian<G> EmModel<ProjectedGaussian<G>>::prepared(const Density& density,
                                                             const EmSettings& settings) {
  const Eigen::Vector3d u = density.tangent_mean().template head<3>();
  const Density start = u.isZero(0.0) ? density : change_chart_to_mode(density);
  const Covariance within = within_bounds(start.covariance(), settings);
  return Density::trusted(start.tangent_point(), start.tangent_mean(), within);
}

template struct EmModel<ProjectedGaussian<SO3d>>;
template struct EmModel<ProjectedGaussian<SE3d>>;

}  // namespace posemix
