// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "noise_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace posemix::internal {
namespace {

/// Axes whose noise has one scale: the first of them, and their number.
struct AxisGroup {
  int first;
  int count;
};
constexpr std::array<AxisGroup, 4> kGroups{{{0, 2}, {2, 1}, {3, 2}, {5, 1}}};

/// The scale of the slow error that goes with a scale of the white one. Innovations show the white
/// error alone: a quiet recording is not less biased, so that the slow error keeps its size down to
/// a scale of 0.4. Where the white error is smaller still, from many views, the detector is a
/// better one, and its slow error is smaller by the power 1.5 (docs/many-objects.md, "The scale of
/// the noise").
double slow_scale(double noise_scale) { return std::min(1.0, std::pow(2.5 * noise_scale, 1.5)); }

/// Whether more than rounding is left of the covariance of an innovation. Where a camera is known
/// far worse than a detection sees it nothing is, and it tells nothing of the noise.
bool is_precise(const Matrix6d& s) {
  constexpr double kRounding = 1e-14;
  const Vector6d factor = Cholesky6(s).factor().diagonal();
  return (factor.array().square() > kRounding * s.diagonal().array().abs()).all();
}

/// The largest change of a log variance by one detection.
constexpr double kLargestStep = 1.0;

/// Squared Mahalanobis distance of six coordinates that 0.1 % of the inliers exceed.
constexpr double kSurprising = 22.46;

/// Number of detections before a change of the slow error and after it by whose means it shows.
constexpr double kDetections = 10.0;

/// So many detections in succession that are inliers by the noise as given, and not by that which
/// was learned, are no gross errors.
constexpr std::uint64_t kSurprises = 10;

/// The largest scale of covariances that observations bring themselves: detectors that state one
/// count what they see, and not what their calibration lacks.
constexpr double kLargestGivenScale = 10.0;

}  // namespace

double clarity(std::span<const ObservationComponent> components) {
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

std::optional<Matrix6d> LearnedSensor::common_covariance() const {
  const std::optional<Matrix6d>& common = sensor_.common_covariance();
  if (!common || !sensor_.noise.dependence().is_typical) return common;
  // Rotation and translation have one scale each: the axes of the two errors are not the same.
  Vector6d scale;
  scale.head<3>().setConstant(sensor_.slow_scale.head<3>().norm() / std::sqrt(3.0));
  scale.tail<3>().setConstant(sensor_.slow_scale.tail<3>().norm() / std::sqrt(3.0));
  return Matrix6d(scale.asDiagonal() * *common * scale.asDiagonal());
}

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
                              const MultiObjectSettings& settings, double least_part) {
  const GivenCovariance use = sensor_.noise.dependence().given_covariance;
  if (has_covariance && use == GivenCovariance::as_given) return Vector6d::Ones();
  if (!std::isfinite(settings.noise_scale_detections)) return Vector6d::Ones();
  const Innovation& inlier = update.explanation.inlier();
  const SE3d to_axes = inlier.axes.inverse();
  const Matrix6d s = to_axes.adjoint_congruence(inlier.covariance);
  if (!is_precise(s)) return Vector6d::Ones();
  const Vector6d z = to_axes.adjoint_blocks().times(inlier.residual);
  const Matrix6d s_inverse = s.inverse();
  const Vector6d y = s_inverse * z;
  double weight = inlier.weight;
  if (has_learned_wrong(inlier, s, z, y.dot(z))) {
    weight = 1.0;
    information_.setZero();
    turned_.setZero();
    looked_s_ = 0.0;
    shown_.setZero();
  }
  if (weight <= 0.0) return Vector6d::Ones();
  const Vector6d scale = sensor_.noise_scale;
  const double largest =
      has_covariance && use == GivenCovariance::scaled ? kLargestGivenScale : 1.0;
  for (const auto& [first, count] : kGroups) {
    Matrix6d r = Matrix6d::Zero();
    r.block(first, first, count, count) = inlier.white.block(first, first, count, count);
    const Matrix6d s_r = s_inverse * r;
    const double score = 0.5 * (std::min(y.dot(r * y), 9.0 * count) - s_r.trace());
    const double information = 0.5 * (s_r * s_r).trace();
    if (information < 0.5 * least_part * least_part * count) continue;
    information_[first] += weight * information;
    const double prior = 0.5 * settings.noise_scale_detections * count;
    const double step =
        std::clamp(weight * score / (prior + information_[first]), -kLargestStep, kLargestStep);
    for (int i = first; i < first + count; ++i) {
      sensor_.noise_scale[i] =
          std::clamp(scale[i] * std::exp(0.5 * step), settings.least_noise_scale, largest);
    }
  }
  return learn_slow_scale();
}

/// That of a noise that is stated is as given. That of a typical one is as large as goes with the
/// white error, and as given while the slow error does not change: a detector that looks at one
/// picture for long has small innovations whatever its slow error is.
/// A slow error as given, of the covariance B, differs from what it was by 2 (1 - a) B, and means
/// of the white error by 2 s^2 / kDetections of its covariance. The information on B that such a
/// difference brings grows with the square of the ratio of the two; that of what is given counts 1.
Vector6d LearnedSensor::learn_slow_scale() {
  Vector6d changed = Vector6d::Ones();
  const NoiseDependence& dependence = sensor_.noise.dependence();
  const auto& slow = dependence.slow;
  if (!slow || !dependence.is_typical || sensor_.slow_units) return changed;
  const double a = slow->correlation(looked_s_, turned_.norm());
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double s = sensor_.noise_scale[i];
    const double information = std::pow(kDetections * (1.0 - a) / (s * s), 2);
    shown_[i] = std::max(shown_[i], information / (1.0 + information));
    const double next = given_slow_scale_[i] * (1.0 - shown_[i] * (1.0 - slow_scale(s)));
    changed[i] = next / std::exchange(sensor_.slow_scale[i], next);
  }
  return changed;
}

/// Counts surprises; whether there are so many that what was learned does not hold any more.
/// Errors that are alike are those of a wrong mode, and tell nothing of the white error.
bool LearnedSensor::has_learned_wrong(const Innovation& inlier, const Matrix6d& s,
                                      const Vector6d& z, double squared_distance) {
  if (squared_distance <= kSurprising) {
    surprises_ = 0;
    return false;
  }
  if (!is_plausible_as_given(inlier, s, z)) return false;
  const Vector6d change = z - std::exchange(surprise_, z);
  const double squared_change = change.dot(inlier.white.llt().solve(change)) / 2.0;
  surprises_ = squared_change > kSurprising ? surprises_ + 1 : 1;
  return surprises_ >= kSurprises;
}

/// Whether a residual z of covariance S, along the axes of the noise, is one of the white error as
/// it was given.
bool LearnedSensor::is_plausible_as_given(const Innovation& inlier, const Matrix6d& s,
                                          const Vector6d& z) const {
  const Vector6d back = given_noise_scale_.cwiseQuotient(sensor_.noise_scale);
  const Matrix6d given = back.asDiagonal() * inlier.white * back.asDiagonal();
  const Eigen::LLT<Matrix6d> factor(s + given - inlier.white);
  return factor.info() == Eigen::Success && z.dot(factor.solve(z)) <= kSurprising;
}

void LearnedSensor::reset() {
  ObjectSensor given = std::move(sensor_);
  given.noise_scale = given_noise_scale_;
  given.slow_scale = given_slow_scale_;
  *this = LearnedSensor(std::move(given));
}

}  // namespace posemix::internal
