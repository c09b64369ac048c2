// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detector/noise_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace posemix::internal {
namespace {

/// A weight of clutter of zero would make it impossible, which no detector is.
constexpr double kPossibleClutter = 1e-6;

bool is_centred(const NoiseComponent& component) { return component.offset.log().norm() == 0.0; }

/// The covariance of the error in common, along the axes and in the units of the components: on
/// average over all directions, and for NoiseFrame::ray at the mean inverse square of the range.
Matrix6d common_along(const Matrix6d& common, NoiseFrame frame,
                      std::span<const NoiseTrack> tracks) {
  if (frame == NoiseFrame::object) return common;
  double unit = 1.0;
  if (frame == NoiseFrame::ray) {
    const std::vector<NoiseObservation> observations = observations_of(tracks);
    unit = 0.0;
    for (const NoiseObservation& each : observations)
      unit +=
          std::pow(viewing_ray(each.truth).range, -2) / static_cast<double>(observations.size());
  }
  Vector6d variances;
  variances.head<3>().setConstant(common.diagonal().head<3>().mean());
  variances.tail<3>().setConstant(unit * common.diagonal().tail<3>().mean());
  return variances.asDiagonal();
}

/// `covariance` less `lasting`, but in no direction less than `least`.
Matrix6d without(const Matrix6d& covariance, const Matrix6d& lasting, const Matrix6d& least) {
  if (covariance.isDiagonal(0.0) && lasting.isDiagonal(0.0) && least.isDiagonal(0.0)) {
    const Vector6d rest = (covariance - lasting).diagonal().cwiseMax(least.diagonal());
    return rest.asDiagonal();
  }
  const Matrix6d factor = least.llt().matrixL();
  const Matrix6d whitening = factor.inverse();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(whitening * (covariance - lasting) *
                                                      whitening.transpose());
  const Matrix6d axes = factor * eigen.eigenvectors();
  Matrix6d rest = axes * eigen.eigenvalues().cwiseMax(1.0).asDiagonal() * axes.transpose();
  symmetrize(rest);
  return rest;
}

}  // namespace

std::size_t inlier_index(const DetectorNoise& noise) {
  const auto& components = noise.components();
  std::size_t best = components.size();
  for (std::size_t i = 0; i < components.size(); ++i) {
    if (!is_centred(components[i])) continue;
    if (best == components.size() || components[i].weight > components[best].weight) best = i;
  }
  return best == components.size() ? 0 : best;
}

DetectorNoise assembled_noise(const DetectorNoise& mixture, const SlowErrorFit& slow_error,
                              const NoiseCorrelation& correlation,
                              std::span<const NoiseTrack> tracks, double least_clutter,
                              double clutter_volume_m3) {
  std::vector<NoiseComponent> components = mixture.components();
  const std::size_t inlier = inlier_index(mixture);
  if (slow_error.slow || slow_error.common) {
    Matrix6d lasting = Matrix6d::Zero();
    if (slow_error.slow) lasting += slow_error.slow->covariance;
    if (slow_error.common)
      lasting += common_along(*slow_error.common, components[inlier].frame, tracks);
    for (std::size_t i = 0; i < components.size(); ++i) {
      Matrix6d& covariance = components[i].covariance;
      covariance = i == inlier ? slow_error.white : without(covariance, lasting, slow_error.white);
    }
  }
  const double run = std::isfinite(correlation.outlier.within) ? correlation.outlier.within : 0.0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    if (i != inlier && is_centred(components[i])) components[i].run_length = std::max(1.0, run);
  }
  const double mode_time_s = run * seconds_per_frame(tracks);
  Clutter clutter = mixture.clutter();
  const double least = std::max(least_clutter, kPossibleClutter);
  if (clutter.weight < least) {
    // The weights of the components sum to one less that of clutter, which stays so.
    for (NoiseComponent& component : components)
      component.weight *= (1.0 - least) / (1.0 - clutter.weight);
    clutter = {.weight = least, .volume_m3 = clutter_volume_m3};
  }
  return DetectorNoise(std::move(components), clutter,
                       {.slow = slow_error.slow,
                        .common = slow_error.common,
                        .mode_time_s = std::isfinite(mode_time_s) ? mode_time_s : 0.0});
}

}  // namespace posemix::internal
