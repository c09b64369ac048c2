// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detector/slow_error_parameters.hpp"

#include <algorithm>
#include <cmath>

#include "posemix/base/statistics.hpp"

namespace posemix::internal {
namespace {

constexpr double kLeastSdRatio = 1e-3;
constexpr double kGreatestSdRatio = 10.0;
constexpr double kLeastLengthRatio = 0.1;     ///< by what lies between successive detections
constexpr double kGreatestLengthRatio = 1e3;  ///< by what a track passes
/// In the logs, a parameter this near to a bound is at it.
constexpr double kAtBound = 1e-3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double median_or(const std::vector<double>& values, double otherwise) {
  const double middle = values.empty() ? 0.0 : median(values);
  return middle > 0.0 ? middle : otherwise;
}

}  // namespace

AxisGroups axis_groups(const NoiseComponent& inlier, std::size_t recordings) {
  constexpr std::size_t kRecordingsForAllAxes = 5;
  if (inlier.frame == NoiseFrame::ray) return {{0, 0, 1, 2, 2, 3}, Vector6d::Ones(), 4};
  if (recordings >= kRecordingsForAllAxes) return {{0, 1, 2, 3, 4, 5}, Vector6d::Ones(), 6};
  return {{0, 0, 0, 1, 1, 1}, inlier.covariance.diagonal().cwiseSqrt(), 2};
}

SlowScales slow_scales(std::span<const SlowTrack> tracks, const AxisGroups& groups) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(groups.count));
  Eigen::VectorXd counts = squares;
  Vector6d object_squares = Vector6d::Zero();
  double rows = 0.0;
  std::vector<double> angles;
  std::vector<double> times;
  std::vector<double> track_angles;
  std::vector<double> track_times;
  for (const SlowTrack& track : tracks) {
    double angle = 0.0;
    double time = 0.0;
    for (const SlowRow& row : track.rows) {
      for (Eigen::Index axis = 0; axis < 6; ++axis) {
        const auto group = static_cast<Eigen::Index>(groups.group[static_cast<std::size_t>(axis)]);
        squares[group] += std::pow(row.residual[axis] / groups.scale[axis], 2);
        counts[group] += 1.0;
      }
      object_squares += row.from_object.partialPivLu().solve(row.residual).cwiseAbs2();
      rows += 1.0;
      angle += row.angle_rad;
      time += row.time_s;
      if (row.angle_rad > 0.0) angles.push_back(row.angle_rad);
      if (row.time_s > 0.0) times.push_back(row.time_s);
    }
    track_angles.push_back(angle);
    if (std::isfinite(time)) track_times.push_back(time);
  }
  SlowScales scales{.sd = (squares.cwiseQuotient(counts)).cwiseSqrt().cwiseMax(1e-12),
                    .object_sd = (object_squares / rows).cwiseSqrt().cwiseMax(1e-12),
                    .least_angle_rad = median_or(angles, 1e-3),
                    .angle_rad = 0.0,
                    .least_time_s = median_or(times, 1e-3),
                    .time_s = 0.0};
  scales.angle_rad = std::max(median_or(track_angles, 1.0), 10.0 * scales.least_angle_rad);
  scales.time_s = std::max(median_or(track_times, 1.0), 10.0 * scales.least_time_s);
  return scales;
}

std::vector<double> SlowParameters::by_scale(const SlowScales& scales, double sd, double least,
                                             double greatest) const {
  std::vector<double> x;
  for (int part = 0; part < (has_slow() ? 2 : 1); ++part) {
    for (const double each : scales.sd) x.push_back(std::log(sd * each));
  }
  if (has_angle()) {
    x.push_back(
        std::log(least > 0.0 ? least * scales.least_angle_rad : greatest * scales.angle_rad));
  }
  if (has_time())
    x.push_back(std::log(least > 0.0 ? least * scales.least_time_s : greatest * scales.time_s));
  if (common_) {
    for (const double each : scales.object_sd) x.push_back(std::log(sd * each));
  }
  return x;
}

std::vector<double> SlowParameters::lower(const SlowScales& scales) const {
  return by_scale(scales, kLeastSdRatio, kLeastLengthRatio, 0.0);
}

std::vector<double> SlowParameters::upper(const SlowScales& scales) const {
  return by_scale(scales, kGreatestSdRatio, 0.0, kGreatestLengthRatio);
}

SlowVariances SlowParameters::variances(std::span<const double> x, const SlowScales& scales) const {
  SlowVariances result{.has_common = common_};
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const std::size_t group = groups_.group[static_cast<std::size_t>(axis)];
    const double scale = std::pow(groups_.scale[axis], 2);
    result.white[axis] = scale * std::exp(2.0 * x[group]);
    if (has_slow()) result.slow[axis] = scale * std::exp(2.0 * x[slow_at() + group]);
  }
  const auto length = [](double log, double passed) {
    return log > std::log(kGreatestLengthRatio * passed) - kAtBound ? kInfinity : std::exp(log);
  };
  if (has_angle()) result.angle_rad = length(x[angle_at()], scales.angle_rad);
  if (has_time()) result.time_s = length(x[time_at()], scales.time_s);
  for (std::size_t axis = 0; common_ && axis < 6; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    const double log = x[common_at() + axis];
    const bool is_zero = log < std::log(kLeastSdRatio * scales.object_sd[at]) + kAtBound;
    result.common[at] = is_zero ? 0.0 : std::exp(2.0 * log);
  }
  return result;
}

}  // namespace posemix::internal
