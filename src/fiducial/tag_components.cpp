// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "posemix/base/error.hpp"
#include "posemix/fiducial/corner_noise.hpp"
#include "posemix/fiducial/tag_pose.hpp"

namespace posemix {
namespace {

/// Degrees of freedom of eight coordinates after a pose is fitted.
constexpr double kResidualDof = 2.0;

void check_noise(const CornerNoise& noise) {
  if (!(noise.sd_px > 0.0) || std::isinf(noise.sd_px)) {
    throw InvalidInput(
        fmt::format("the noise of corners is {} px, expected a number above zero", noise.sd_px));
  }
  if (!(noise.dof > 0.0)) {
    throw InvalidInput(fmt::format(
        "the noise of corners has {} degrees of freedom, expected more than zero", noise.dof));
  }
}

/// log |m|^(-1/2)
double log_width(const Matrix6d& information) {
  // Scaled, because entries for rotation and translation differ by orders of magnitude.
  const Vector6d scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LDLT<Matrix6d> factor(scaled);
  return scale.array().log().sum() - 0.5 * factor.vectorD().array().log().sum();
}

Matrix6d inverse_of(const Matrix6d& information) {
  const Vector6d scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = scale.asDiagonal() * information * scale.asDiagonal();
  Matrix6d inverse = scale.asDiagonal() *
                     Eigen::LDLT<Matrix6d>(scaled).solve(Matrix6d::Identity()) * scale.asDiagonal();
  symmetrize(inverse);
  return inverse;
}

/// The variance of a corner's coordinate that noise and squared error say together [px^2].
double variance(const CornerNoise& noise, double squared_error) {
  const double usual = noise.sd_px * noise.sd_px;
  return std::isinf(noise.dof) ? usual : usual + squared_error / noise.dof;
}

}  // namespace

double log_evidence(const TagMinimum& minimum, const CornerNoise& noise) {
  const double share = minimum.squared_error / (noise.sd_px * noise.sd_px);
  const double misfit = std::isinf(noise.dof)
                            ? -0.5 * share
                            : -0.5 * (noise.dof + kResidualDof) * std::log1p(share / noise.dof);
  return log_width(minimum.information) + misfit;
}

std::vector<ObservationComponent> tag_components(const std::vector<TagMinimum>& minima,
                                                 const CornerNoise& noise, double least_weight) {
  check_noise(noise);
  std::vector<double> evidence;
  evidence.reserve(minima.size());
  for (const TagMinimum& minimum : minima) evidence.push_back(log_evidence(minimum, noise));
  if (minima.empty()) return {};
  const double best = *std::max_element(evidence.begin(), evidence.end());
  double total = 0.0;
  for (double& value : evidence) total += value = std::exp(value - best);
  double kept = 0.0;
  for (double& value : evidence) {
    value /= total;
    if (value < least_weight && value < 1.0 / static_cast<double>(minima.size())) value = 0.0;
    kept += value;
  }
  std::vector<ObservationComponent> components;
  for (std::size_t k = 0; k < minima.size(); ++k) {
    if (!(evidence[k] > 0.0)) continue;
    components.push_back({.weight = evidence[k] / kept,
                          .pose = minima[k].pose,
                          .covariance = inverse_of(minima[k].information) *
                                        variance(noise, minima[k].squared_error)});
  }
  std::stable_sort(components.begin(), components.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return components;
}

void add_bearing_error(std::vector<ObservationComponent>& components, double sd_rad) {
  if (!(sd_rad >= 0.0) || std::isinf(sd_rad)) {
    throw InvalidInput(
        fmt::format("the error of the bearing is {} rad, expected zero or more", sd_rad));
  }
  // On the left of T_camera_tag, along the axes of the camera.
  Matrix6d of_camera = Matrix6d::Zero();
  of_camera.topLeftCorner<3, 3>().diagonal().setConstant(sd_rad * sd_rad);
  for (ObservationComponent& component : components) {
    if (!component.covariance) continue;
    *component.covariance += component.pose.inverse().adjoint_congruence(of_camera);
    symmetrize(*component.covariance);
  }
}

}  // namespace posemix
