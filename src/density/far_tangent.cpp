// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "far_tangent.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "mean_rotation.hpp"

namespace posemix::internal {
namespace {

/// The integrand is analytic for |Im x| < pi / 2, so that the error is exp(-pi^2 / kStep).
constexpr double kStep = 0.25;
constexpr double kLast = 5.0;    // exp(-exp(5)) is nothing
constexpr double kBelow = 20.0;  // exp(2 x) is exp(-40) there
/// Beyond it m.m overflows; the rotation is half a turn long before.
constexpr double kFarthest = 1e150;

}  // namespace

FarTangent::FarTangent(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  axes_ = eigen.eigenvectors();
  mean_ = (axes_.transpose() * mean).array().max(-kFarthest).min(kFarthest);
  variances_ = eigen.eigenvalues().array().max(0.0);
  // Where every term of g has become as large as one.
  const double size = 1.0 + mean_.square().sum() + 2.0 * variances_.sum();
  const double first = (std::isfinite(size) ? -std::log(size) : 0.0) - kBelow;
  const auto count = static_cast<std::size_t>(std::ceil((kLast - first) / kStep)) + 1;
  for (std::size_t k = 0; k < count; ++k) {
    x_.push_back(first + kStep * static_cast<double>(k));
    g_.push_back(g(std::exp(x_.back())));
  }
}

double FarTangent::g(double s) const {
  const Eigen::Array3d twice = 2.0 * s * variances_;
  return s + 0.5 * twice.log1p().sum() + s * (mean_.square() / (1.0 + twice)).sum();
}

Eigen::Array3d FarTangent::mean_at(double s) const { return mean_ / (1.0 + 2.0 * s * variances_); }

Eigen::Array3d FarTangent::variance_at(double s) const {
  return variances_ / (1.0 + 2.0 * s * variances_);
}

double FarTangent::log_normalizer() const {
  double largest = 2.0 * x_.front() - g_.front();
  for (std::size_t k = 0; k < x_.size(); ++k) largest = std::max(largest, 2.0 * x_[k] - g_[k]);
  double sum = 0.0;
  for (std::size_t k = 0; k < x_.size(); ++k) sum += std::exp(2.0 * x_[k] - g_[k] - largest);
  return largest + std::log(kStep * sum);
}

ProjectedMoments FarTangent::moments() const {
  ProjectedMoments found{log_normalizer(), Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero(), {}};
  // E[f(u) / (1 + u.u)] = sum of weight s / 2 times E[f(u) | s], as in projected_moments.
  double third = 0.0;
  Eigen::Vector3d first_of_third = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second_of_third = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < x_.size(); ++k) {
    const double s = std::exp(x_[k]);
    const double weight = kStep * std::exp(2.0 * x_[k] - g_[k] - found.log_normalizer);
    const Eigen::Vector3d mean = mean_at(s);
    Eigen::Matrix3d second = mean * mean.transpose();
    second.diagonal() += variance_at(s).matrix();
    found.mean += weight * mean;
    found.second_moment += weight * second;
    third += 0.5 * s * weight;
    first_of_third += 0.5 * s * weight * mean;
    second_of_third += 0.5 * s * weight * second;
  }
  found.mean = axes_ * found.mean;
  found.second_moment = axes_ * found.second_moment * axes_.transpose();
  found.rotation =
      mean_rotation(third, axes_ * first_of_third, axes_ * second_of_third * axes_.transpose());
  return found;
}

Eigen::Vector3d FarTangent::sample(RandomStream& stream) const {
  // From x_k to x_k+1, f is below 2 x_k+1 - g_k.
  const std::size_t steps = x_.size() - 1;
  std::vector<double> above(steps);
  for (std::size_t k = 0; k < steps; ++k) above[k] = 2.0 * x_[k + 1] - g_[k];
  const double largest = *std::max_element(above.begin(), above.end());
  std::vector<double> cumulative(steps);
  double sum = 0.0;
  for (std::size_t k = 0; k < steps; ++k) cumulative[k] = sum += std::exp(above[k] - largest);
  while (true) {
    const auto at =
        std::lower_bound(cumulative.begin(), cumulative.end() - 1, sum * stream.uniform());
    const auto k = static_cast<std::size_t>(at - cumulative.begin());
    const double x = x_[k] + kStep * stream.uniform();
    const double s = std::exp(x);
    if (std::log1p(-stream.uniform()) > 2.0 * x - g(s) - above[k]) continue;
    Eigen::Array3d white;
    for (double& value : white) value = stream.normal();
    return axes_ * (mean_at(s) + variance_at(s).sqrt() * white).matrix();
  }
}

}  // namespace posemix::internal
