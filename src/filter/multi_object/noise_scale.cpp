// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "noise_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace posemix::internal {
namespace {

/// Axes whose noise has one scale: the first of them, and their number.
struct AxisGroup {
  int first;
  int count;
};
constexpr std::array<AxisGroup, 4> kGroups{{{0, 2}, {2, 1}, {3, 2}, {5, 1}}};

/// The scale of the slow error for a scale of the white one. Innovations show the white error
/// alone: a quiet recording is not less biased, so that the slow error keeps its size down to a
/// scale of 0.4. Where the white error is smaller still, the detector is a better one, and its slow
/// error is smaller by the power 1.5 (docs/many-objects.md, "The scale of the noise").
double slow_scale(double noise_scale) { return std::min(1.0, std::pow(2.5 * noise_scale, 1.5)); }

/// The largest change of a log variance by one detection.
constexpr double kLargestStep = 1.0;

/// The largest scale of covariances that observations bring themselves: detectors that state one
/// count what they see, and not what their calibration lacks.
constexpr double kLargestGivenScale = 10.0;

}  // namespace

double clarity(const std::vector<ObservationComponent>& components) {
  double first = 0.0;
  double second = 0.0;
  for (const ObservationComponent& component : components) {
    second = std::max(second, std::min(first, component.weight));
    first = std::max(first, component.weight);
  }
  return second > 0.0 ? std::log(first / second) : 0.0;
}

LearnedSensor::LearnedSensor(ObjectSensor sensor)
    : sensor_(std::move(sensor)),
      given_noise_scale_(sensor_.noise_scale),
      given_slow_scale_(sensor_.slow_scale) {}

double LearnedSensor::new_share(double now_s) const {
  const double mode_time = sensor_.noise.dependence().mode_time_s;
  if (detections_ == 0 || mode_time <= 0.0) return 1.0;
  return -std::expm1(-(now_s - last_s_) / mode_time);
}

double LearnedSensor::weight_share(const Observation& observation, double now_s) const {
  const double share = new_share(now_s);
  const double says = clarity(observation.components);
  return says > told_ ? share + (1.0 - share) * (1.0 - told_ / says) : share;
}

double LearnedSensor::count_detection(const WeighedObservation& observation, double now_s) {
  const double share = new_share(now_s);
  ++detections_;
  last_s_ = now_s;
  told_ = std::max((1.0 - share) * told_, observation.clarity);
  return share;
}

/// Fisher scoring for the log variance v of every group of axes. With S = H P H^T + R,
/// y = S^-1 z and the group's part R_g of R, the score of log N(z; 0, S) is
/// (y^T R_g y - tr S^-1 R_g) / 2 and its information tr(S^-1 R_g S^-1 R_g) / 2. The noise as given
/// counts as settings.noise_scale_detections detections.
Vector6d LearnedSensor::learn(const DetectionUpdate& update, bool has_covariance,
                              const MultiObjectSettings& settings) {
  const GivenCovariance use = sensor_.noise.dependence().given_covariance;
  if (has_covariance && use == GivenCovariance::as_given) return Vector6d::Ones();
  if (!std::isfinite(settings.noise_scale_detections)) return Vector6d::Ones();
  const Innovation& inlier = update.explanation.inlier();
  if (inlier.weight <= 0.0) return Vector6d::Ones();
  const SE3d to_axes = inlier.axes.inverse();
  const Matrix6d s_inverse = Matrix6d(to_axes.adjoint_congruence(inlier.covariance)).inverse();
  const Vector6d y = s_inverse * to_axes.adjoint_blocks().times(inlier.residual);
  const Vector6d scale = sensor_.noise_scale;
  const double largest =
      has_covariance && use == GivenCovariance::scaled ? kLargestGivenScale : 1.0;
  Vector6d changed = Vector6d::Ones();
  for (const auto& [first, count] : kGroups) {
    Matrix6d r = Matrix6d::Zero();
    for (int i = first; i < first + count; ++i) {
      for (int k = first; k < first + count; ++k) r(i, k) = inlier.white(i, k);
    }
    const Matrix6d s_r = s_inverse * r;
    const double score = 0.5 * (std::min(y.dot(r * y), 9.0 * count) - s_r.trace());
    const double information = 0.5 * (s_r * s_r).trace();
    information_[first] += inlier.weight * information;
    const double prior = 0.5 * settings.noise_scale_detections * count;
    const double step = std::clamp(inlier.weight * score / (prior + information_[first]),
                                   -kLargestStep, kLargestStep);
    for (int i = first; i < first + count; ++i) {
      sensor_.noise_scale[i] =
          std::clamp(scale[i] * std::exp(0.5 * step), settings.least_noise_scale, largest);
      const double slow = slow_scale(sensor_.noise_scale[i]) * given_slow_scale_[i];
      if (!sensor_.slow_units) changed[i] = slow / std::exchange(sensor_.slow_scale[i], slow);
    }
  }
  return changed;
}

void LearnedSensor::reset() {
  ObjectSensor given = std::move(sensor_);
  given.noise_scale = given_noise_scale_;
  given.slow_scale = given_slow_scale_;
  *this = LearnedSensor(std::move(given));
}

}  // namespace posemix::internal
