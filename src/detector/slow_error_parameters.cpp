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
constexpr double kLeastSd = 1e-12;            ///< where there is no error at all
/// In the logs, a parameter this near to a bound is at it.
constexpr double kAtBound = 1e-3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double median_or(const std::vector<double>& values, double otherwise) {
  const double middle = values.empty() ? 0.0 : median(values);
  return middle > 0.0 ? middle : otherwise;
}

/// The logs of the deviations of groups whose axes have these deviations.
void add_group_logs(const Vector6d& sd, const AxisGroups& groups, std::vector<double>& x) {
  std::vector<double> squares(groups.count, 0.0);
  std::vector<double> counts(groups.count, 0.0);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    squares[groups.group[axis]] += std::pow(sd[at] / groups.scale[at], 2);
    counts[groups.group[axis]] += 1.0;
  }
  for (std::size_t g = 0; g < groups.count; ++g)
    x.push_back(0.5 * std::log(squares[g] / counts[g]));
}

/// Deviations of the change from one detection to the next, in which the white errors are, and not
/// what a recording has in common.
Vector6d sd_between(std::span<const SlowTrack> tracks) {
  Vector6d squares = Vector6d::Zero();
  double count = 0.0;
  for (const SlowTrack& track : tracks) {
    for (std::size_t i = 1; i < track.rows.size(); ++i) {
      squares += (track.rows[i].residual - track.rows[i - 1].residual).cwiseAbs2();
      count += 1.0;
    }
  }
  return (squares / std::max(1.0, count)).cwiseSqrt().cwiseMax(kLeastSd);
}

/// The variances of the axes from the logs of the deviations of their groups, from `first` on.
Vector6d axis_variances(std::span<const double> x, std::size_t first, const AxisGroups& groups) {
  Vector6d variances;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    variances[at] = std::pow(groups.scale[at], 2) * std::exp(2.0 * x[first + groups.group[axis]]);
  }
  return variances;
}

}  // namespace

std::vector<PartGroups> part_groups(NoiseFrame frame, std::span<const SlowTrack> tracks,
                                    std::size_t recordings) {
  constexpr std::size_t kRecordingsForAllAxes = 5;
  const AxisGroups all{{0, 1, 2, 3, 4, 5}, Vector6d::Ones(), 6};
  const AxisGroups about_ray{{0, 0, 1, 2, 2, 3}, Vector6d::Ones(), 4};
  if (frame == NoiseFrame::ray) return {{about_ray, about_ray}};
  if (recordings >= kRecordingsForAllAxes) return {{all, all}};
  return {{all, {{0, 0, 0, 1, 1, 1}, sd_between(tracks), 2}}, {all, all}};
}

SlowScales slow_scales(std::span<const SlowTrack> tracks) {
  Vector6d squares = Vector6d::Zero();
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
      squares += row.residual.cwiseAbs2();
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
  SlowScales scales{.sd = (squares / rows).cwiseSqrt().cwiseMax(kLeastSd),
                    .object_sd = (object_squares / rows).cwiseSqrt().cwiseMax(kLeastSd),
                    .least_angle_rad = median_or(angles, 1e-3),
                    .angle_rad = 0.0,
                    .least_time_s = median_or(times, 1e-3),
                    .time_s = 0.0};
  scales.angle_rad = std::max(median_or(track_angles, 1.0), 10.0 * scales.least_angle_rad);
  scales.time_s = std::max(median_or(track_times, 1.0), 10.0 * scales.least_time_s);
  return scales;
}

std::vector<double> SlowParameters::deviations(const SlowScales& scales, double factor) const {
  std::vector<double> x;
  add_group_logs(factor * scales.sd, groups_.white, x);
  if (has_slow()) add_group_logs(factor * scales.sd, groups_.slow, x);
  return x;
}

std::vector<double> SlowParameters::by_scale(const SlowScales& scales, double sd, double least,
                                             double greatest) const {
  std::vector<double> x = deviations(scales, sd);
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
  result.white = axis_variances(x, 0, groups_.white);
  if (has_slow()) result.slow = axis_variances(x, slow_at(), groups_.slow);
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
