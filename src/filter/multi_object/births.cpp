// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <numbers>

#include "multi_object_state.hpp"
#include "posemix/filter/update.hpp"

namespace posemix::internal {
namespace {

/// Offsets nearer to each other than this are one mode.
constexpr double kSameMode = 1e-9;

/// A mode of a detector's noise: the components with the same offset.
struct NoiseMode {
  const NoiseComponent* first;
  double log_weight;  ///< log of the summed weights
};

bool same_mode(const NoiseComponent& a, const NoiseComponent& b) {
  return (a.offset.inverse() * b.offset).log().norm() < kSameMode;
}

/// The modes of the noise, every weight times exp(log_factor).
std::vector<NoiseMode> modes_of(const DetectorNoise& noise, double log_factor) {
  std::vector<NoiseMode> modes;
  for (const NoiseComponent& component : noise.components()) {
    const auto mode = std::find_if(modes.begin(), modes.end(), [&](const NoiseMode& other) {
      return same_mode(*other.first, component);
    });
    if (mode == modes.end()) {
      modes.push_back({&component, log_factor + std::log(component.weight)});
    } else {
      // log(exp(a) + w exp(d)) = a + log(1 + w / exp(a - d)).
      mode->log_weight += std::log1p(component.weight / std::exp(mode->log_weight - log_factor));
    }
  }
  return modes;
}

/// Covariance of the white error of a mode: the moments of its components.
Matrix6d mode_covariance(const DetectionState& state, const NoiseMode& mode,
                         const ObjectSensor& sensor) {
  Matrix6d sum = Matrix6d::Zero();
  double weight = 0.0;
  for (const NoiseComponent& component : sensor.noise.components()) {
    if (!same_mode(*mode.first, component)) continue;
    sum += component.weight * white_covariance(state, component, sensor);
    weight += component.weight;
  }
  return sum / weight;
}

}  // namespace

/// Hypotheses at a detection that no hypothesis explains, one for each mode of the noise. Their
/// weight is that of absence times the mode's weight and the density of clutter ("Births"); their
/// covariance is the camera's plus a multiple of the noise's.
std::vector<Alternative> MultiObjectState::births_of(const TrackedObject& object,
                                                     const SE3d& detected, double share) {
  constexpr double kPi = std::numbers::pi;
  if (!std::isfinite(object.belief.log_absent())) return {};
  const ObjectSensor& sensor = object.detector.sensor();
  const SE3d& camera = joint.pose(kCamera);
  const Matrix6d camera_covariance = joint.covariance(kCamera, kCamera);
  const double log_density =
      object.belief.log_absent() - std::log(8.0 * kPi * kPi * sensor.noise.clutter().volume_m3);
  std::vector<Alternative> births;
  for (const NoiseMode& mode : modes_of(sensor.noise, log_density)) {
    // xi_O = xi_C - A b - n.
    DetectionState there{.camera = camera,
                         .object = camera * detected * mode.first->offset.inverse()};
    Matrix6d covariance = camera_covariance + mode_covariance(there, mode, sensor);
    ConditionalPose born{there.object, {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
    if (const auto slow = sensor.slow_covariance()) {
      const Matrix6d a_b = slow_error_map(there, *mode.first) * *slow;
      born.slow = Vector6d::Zero();
      covariance += a_b * slow_error_map(there, *mode.first).transpose();
      born.covariance.topRightCorner<6, 6>() = -a_b;
      born.covariance.bottomLeftCorner<6, 6>() = -a_b.transpose();
      born.covariance.bottomRightCorner<6, 6>() = *slow;
    }
    born.covariance.topLeftCorner<6, 6>() = covariance;
    born.cross_covariance.topRows<6>() = camera_covariance;
    births.push_back({{.log_weight = mode.log_weight,
                       .log_probability = object.belief.log_absence_probability() +
                                          share * (mode.log_weight - object.belief.log_absent()),
                       .score = settings.birth_score,
                       .id = next_id++,
                       .detections = 1},
                      born});
  }
  return births;
}

}  // namespace posemix::internal
