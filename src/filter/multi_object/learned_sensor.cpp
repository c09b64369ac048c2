// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "learned_sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace posemix::internal {
namespace {

/// Detections closer in time count as that far apart.
constexpr double kLeastS = 1e-3;

}  // namespace

LearnedSensor::LearnedSensor(ObjectSensor sensor)
    : sensor_(std::move(sensor)), given_noise_scale_(sensor_.noise_scale) {}

double LearnedSensor::correlation_length(const MultiObjectSettings& settings,
                                         double frame_s) const {
  const double interval =
      detections_ > 1 ? (last_s_ - first_s_) / static_cast<double>(detections_ - 1) : frame_s;
  const double prior = sensor_.noise.dependence().dependent_frames.value_or(
      std::max(1.0, settings.correlation_s / std::max(interval, kLeastS)));
  return correlation_.estimate(prior, settings.correlation_detections);
}

Matrix6d LearnedSensor::bias_covariance(const MultiObjectSettings& settings, const SE3d& camera,
                                        const SE3d& object) const {
  const Pair there{camera, object, Matrix12d::Zero()};
  NoiseComponent component = sensor_.noise.components().front();
  if (const auto& bias = sensor_.noise.dependence().bias) {
    component.covariance = *bias;
    return component_noise(there, component, {sensor_.noise});
  }
  return settings.bias_variance_fraction * component_noise(there, component, sensor_);
}

void LearnedSensor::count_detection(double now_s) {
  if (detections_++ == 0) first_s_ = now_s;
  last_s_ = now_s;
}

void LearnedSensor::learn(const PairUpdate& update, const MultiObjectSettings& settings) {
  learn_scale(update, settings);
  if (update.inlier_probability > 0.5) correlation_.add(update.white_residual());
}

/// One scale for the rotation, one for the translation across the ray and one along it. Each is the
/// posterior mean of a variance whose prior, one, counts as settings.noise_scale_detections
/// detections.
void LearnedSensor::learn_scale(const PairUpdate& update, const MultiObjectSettings& settings) {
  if (!std::isfinite(settings.noise_scale_detections)) return;
  const Vector6d ratio = update.residual.cwiseAbs2().cwiseQuotient(update.residual_variance);
  const Vector6d now = sensor_.noise_scale.cwiseAbs2();
  constexpr std::array<std::array<int, 2>, 3> kGroups{{{0, 3}, {3, 2}, {5, 1}}};
  inliers_ += update.inlier_probability;
  const double rate = 1.0 / (settings.noise_scale_detections + inliers_);
  for (const auto& [first, count] : kGroups) {
    // The common error is not seen in the innovations.
    const double change =
        ratio.segment(first, count).mean() / (1.0 - settings.bias_variance_fraction) - 1.0;
    const double variance = now[first] * (1.0 + update.inlier_probability * rate * change);
    sensor_.noise_scale.segment(first, count)
        .setConstant(std::sqrt(
            std::clamp(variance, settings.least_noise_scale * settings.least_noise_scale, 1.0)));
  }
}

void LearnedSensor::reset() {
  ObjectSensor given = std::move(sensor_);
  given.noise_scale = given_noise_scale_;
  *this = LearnedSensor(std::move(given));
}

}  // namespace posemix::internal
