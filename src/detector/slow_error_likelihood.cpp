// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detector/slow_error_likelihood.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "detector/noise_rows.hpp"
#include "posemix/base/error.hpp"
#include "posemix/detector/noise_correlation.hpp"

namespace posemix::internal {
namespace {

using Array6d = Eigen::Array<double, 6, 1>;

/// The scalar Kalman filters of the six axes of a track, which share the correlation. The state of
/// an axis is its slow error.
class AxisFilters {
 public:
  explicit AxisFilters(const SlowVariances& variances)
      : variances_(variances), variance_(variances.slow.array()) {}

  void predict(const SlowRow& row) {
    // A length that is infinite must not meet a time that is missing.
    double exponent = row.angle_rad / variances_.angle_rad;
    if (std::isfinite(variances_.time_s)) exponent += row.time_s / variances_.time_s;
    const double a = std::exp(-exponent);
    mean_ *= a;
    common_mean_ *= a;
    variance_ = a * a * variance_ + (1.0 - a * a) * variances_.slow.array();
  }

  /// Adds the likelihood of the residual given those before it.
  void update(const SlowRow& row) {
    const Array6d innovation_variance = variance_ + variances_.white.array();
    const Array6d gain = variance_ / innovation_variance;
    const Array6d innovation = row.residual.array() - mean_;
    log_likelihood_ -= 0.5 * ((innovation.square() / innovation_variance).sum() +
                              std::log(innovation_variance.prod()) + 6.0 * kLogTwoPi);
    mean_ += gain * innovation;
    if (variances_.has_common) update_common(row, innovation, innovation_variance, gain);
    variance_ *= 1.0 - gain;
  }

  /// With A the effect of the errors in common on the residuals and S the covariance of what else
  /// there is, the covariance S + A C A^T changes the likelihood by
  /// (h^T (C^-1 + G)^-1 h - log |I + C G|) / 2, G = A^T S^-1 A, h = A^T S^-1 e.
  double log_likelihood() const {
    if (!variances_.has_common) return log_likelihood_;
    double sum = log_likelihood_;
    for (const int first : {0, 3}) {
      const Eigen::Vector3d sd = variances_.common.segment<3>(first).cwiseSqrt();
      const Eigen::Matrix3d information = information_.block<3, 3>(first, first);
      const Eigen::LLT<Eigen::Matrix3d> factor(Eigen::Matrix3d::Identity() +
                                               sd.asDiagonal() * information * sd.asDiagonal());
      const Eigen::Vector3d scaled = sd.cwiseProduct(evidence_.segment<3>(first));
      sum += 0.5 * scaled.dot(factor.solve(scaled)) -
             Eigen::Matrix3d(factor.matrixL()).diagonal().array().log().sum();
    }
    return sum;
  }

 private:
  /// The filters are linear, and the same one whitens the effect of an error in common.
  void update_common(const SlowRow& row, const Array6d& innovation, const Array6d& variance,
                     const Array6d& gain) {
    const Eigen::Array<double, 6, 3> effect = effect_of(row) - common_mean_;
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      const Eigen::Index first = axis < 3 ? 0 : 3;
      const Eigen::Vector3d g = effect.row(axis).matrix().transpose();
      information_.block<3, 3>(first, first) += g * g.transpose() / variance[axis];
      evidence_.segment<3>(first) += g * (innovation[axis] / variance[axis]);
    }
    common_mean_ += effect.colwise() * gain;
  }

  /// Rotations of the object's axes err in rotations alone, and translations in translations.
  static Eigen::Array<double, 6, 3> effect_of(const SlowRow& row) {
    Eigen::Array<double, 6, 3> effect;
    effect.topRows<3>() = row.from_object.topLeftCorner<3, 3>();
    effect.bottomRows<3>() = row.from_object.bottomRightCorner<3, 3>();
    return effect;
  }

  const SlowVariances& variances_;
  Array6d mean_ = Array6d::Zero();
  Array6d variance_;
  Eigen::Array<double, 6, 3> common_mean_ = Eigen::Array<double, 6, 3>::Zero();
  Matrix6d information_ = Matrix6d::Zero();
  Vector6d evidence_ = Vector6d::Zero();
  double log_likelihood_ = 0.0;
};

/// What has been passed up to an entry of a track.
struct Progress {
  double angle_rad;
  double stamp_s;
};

/// The path of the viewing direction at an entry, after one at `before`.
double path_at(const NoiseObservation& seen, const std::optional<NoiseObservation>& previous,
               double before) {
  if (std::isfinite(seen.view_path_rad)) return seen.view_path_rad;
  return previous ? before + view_angle(previous->truth, seen.truth) : 0.0;
}

void check_order(const Progress& before, const Progress& now) {
  if (!(now.stamp_s < before.stamp_s) && !(now.angle_rad < before.angle_rad)) return;
  throw InvalidInput(fmt::format(
      "noise model: a detection at {} s and {} rad of the viewing direction's path follows one at "
      "{} s and {} rad, expected an order in which neither decreases",
      now.stamp_s, now.angle_rad, before.stamp_s, before.angle_rad));
}

SlowTrack slow_track(const NoiseTrack& track, const NoiseComponent& inlier,
                     const Eigen::LLT<Matrix6d>& factor) {
  SlowTrack result;
  std::optional<NoiseObservation> previous;
  Progress now{0.0, 0.0};
  std::optional<Progress> last_inlier;
  for (const auto& seen : track) {
    if (!seen) continue;
    const Progress next{path_at(*seen, previous, now.angle_rad), seen->stamp_s};
    if (previous) check_order(now, next);
    now = next;
    previous = seen;
    const SE3d mode = seen->truth * inlier.offset;
    SlowRow row{.residual = detection_residual(mode, seen->detected, inlier.frame),
                .from_object = residual_turn(mode, inlier.frame)};
    if (factor.matrixL().solve(row.residual).squaredNorm() >= kInlierGate) continue;
    if (last_inlier) {
      row.angle_rad = now.angle_rad - last_inlier->angle_rad;
      row.time_s = now.stamp_s - last_inlier->stamp_s;
    }
    last_inlier = now;
    result.recording = seen->recording;
    result.rows.push_back(row);
  }
  return result;
}

}  // namespace

std::vector<SlowTrack> slow_tracks(std::span<const NoiseTrack> tracks,
                                   const NoiseComponent& inlier) {
  const Eigen::LLT<Matrix6d> factor(inlier.covariance);
  std::vector<SlowTrack> result;
  for (const NoiseTrack& track : tracks) {
    SlowTrack rows = slow_track(track, inlier, factor);
    if (!rows.rows.empty()) result.push_back(std::move(rows));
  }
  return result;
}

double log_likelihood(const SlowTrack& track, const SlowVariances& variances) {
  AxisFilters filters(variances);
  bool first = true;
  for (const SlowRow& row : track.rows) {
    if (!first) filters.predict(row);
    first = false;
    filters.update(row);
  }
  return filters.log_likelihood();
}

}  // namespace posemix::internal
