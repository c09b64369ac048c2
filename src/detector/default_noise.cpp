// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/default_noise.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "posemix/base/units.hpp"

namespace posemix {

DetectorNoise default_detector_noise() {
  const auto covariance = [](double across_deg, double about_ray_deg, double across_percent,
                             double along_percent) {
    const Eigen::Vector3d rotation(across_deg, across_deg, about_ray_deg);
    const Eigen::Vector3d translation(across_percent, across_percent, along_percent);
    return pose_covariance(kRadPerDeg * rotation, 0.01 * translation);
  };
  const NoiseComponent inlier{
      .weight = 0.65, .covariance = covariance(3.2, 2.1, 0.36, 3.1), .frame = NoiseFrame::ray};
  NoiseComponent gross = inlier;
  gross.weight = 0.12;
  gross.covariance *= 2.7 * 2.7;
  gross.run_length = 10.0;
  const SlowError slow{.covariance = covariance(5.6, 3.0, 0.8, 5.2),
                       .correlation_angle_rad = 90.0 * kRadPerDeg};
  return DetectorNoise({inlier, gross}, {.weight = 0.23, .volume_m3 = 1.0},
                       {.slow = slow,
                        .common = pose_covariance(Eigen::Vector3d::Constant(2.5 * kRadPerDeg),
                                                  Eigen::Vector3d::Constant(0.005)),
                        .mode_time_s = 30.0,
                        .is_typical = true});
}

DetectorNoise with_assumed_slow_error(const DetectorNoise& noise) {
  const auto in_another_frame = [&](const NoiseComponent& component) {
    return component.frame != noise.components().front().frame;
  };
  if (noise.dependence().slow ||
      std::any_of(noise.components().begin(), noise.components().end(), in_another_frame))
    return noise;
  const auto remainders_are_covariances = [&](const Matrix6d& slow) {
    const auto is_positive = [&](const NoiseComponent& component) {
      return Eigen::LLT<Matrix6d>(component.covariance - slow).info() == Eigen::Success;
    };
    return std::all_of(noise.components().begin(), noise.components().end(), is_positive);
  };
  Matrix6d slow = kAssumedSlowFraction * noise.components().front().covariance;
  while (!remainders_are_covariances(slow)) slow *= 0.5;
  std::vector<NoiseComponent> components = noise.components();
  for (NoiseComponent& component : components) component.covariance -= slow;
  NoiseDependence dependence = noise.dependence();
  dependence.slow =
      SlowError{.covariance = slow, .correlation_angle_rad = kAssumedCorrelationAngle};
  return DetectorNoise(std::move(components), noise.clutter(), dependence);
}

}  // namespace posemix
