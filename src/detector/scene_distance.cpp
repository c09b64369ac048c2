// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "scene_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "posemix/base/random.hpp"
#include "posemix/base/statistics.hpp"

namespace posemix::internal {
namespace {

/// Distances that are tried: 0, 0.02, ..., 4 m.
constexpr double kStep = 0.02;
constexpr std::size_t kDistances = 201;

SE3d point_at(double distance_m) { return SE3d(SO3d(), Eigen::Vector3d(0.0, 0.0, distance_m)); }

/// Variances over windows of one length in a recording, by distance.
struct WindowVariances {
  double independent = 0.0;
  double count = 0.0;
  double seconds = 0.0;  ///< of all windows together
  std::vector<Vector6d> variance;
};

WindowVariances window_variances(const OdometryRecording& recording, double length) {
  const std::vector<OdometryFrames> windows = odometry_windows(recording, length);
  WindowVariances result;
  if (windows.empty()) return result;
  std::vector<Vector6d> errors;
  double seconds = 0.0;
  for (const auto& [i, j] : windows) {
    const SE3d motion = recording.odometry[i]->inverse() * *recording.odometry[j];
    const SE3d truth = recording.camera_truth[i]->inverse() * *recording.camera_truth[j];
    errors.push_back((truth.inverse() * motion).log());
    seconds += recording.stamps[j] - recording.stamps[i];
  }
  result.count = static_cast<double>(windows.size());
  result.seconds = seconds;
  result.independent = independent_windows(recording, windows.size(), seconds);
  for (std::size_t d = 0; d < kDistances; ++d) {
    // Log(T^-1 Exp(e) T) = Ad(T^-1) e.
    const Matrix6d there = point_at(kStep * static_cast<double>(d)).inverse().adjoint();
    std::vector<Vector6d> moved;
    moved.reserve(errors.size());
    for (const Vector6d& error : errors) moved.emplace_back(there * error);
    result.variance.push_back(robust_variances(moved));
  }
  return result;
}

using RecordingVariances = std::vector<WindowVariances>;  // by length

/// The rate at which variances grow with time: the slope of a weighted regression, for errors of
/// a variance have a deviation in proportion to it. What does not grow is jitter of the truth.
double slope(const std::vector<double>& seconds, const std::vector<double>& variances,
             const std::vector<double>& counts) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    const double weight = counts[i] / std::max(variances[i] * variances[i], 1e-60);
    const Eigen::Vector2d x(1.0, seconds[i]);
    normal += weight * x * x.transpose();
    right += weight * variances[i] * x;
  }
  if (seconds.size() == 1) return variances[0] / seconds[0];
  return normal.ldlt().solve(right)[1];
}

/// The sum of the log rates at which the variances of the coordinates grow, pooled over the
/// recordings that are chosen. Infinite where no rate is positive.
double criterion(const std::vector<RecordingVariances>& all, const std::vector<std::size_t>& chosen,
                 std::size_t d) {
  std::vector<double> seconds;
  std::vector<double> counts;
  std::vector<Vector6d> variances;
  for (std::size_t w = 0; w < all.front().size(); ++w) {
    double count = 0.0;
    double independent = 0.0;
    double time = 0.0;
    Vector6d squares = Vector6d::Zero();
    for (const std::size_t r : chosen) {
      const WindowVariances& window = all[r][w];
      if (window.count == 0.0) continue;
      count += window.count;
      independent += window.independent;
      time += window.seconds;
      squares += window.count * window.variance[d];
    }
    if (count == 0.0) continue;
    seconds.push_back(time / count);
    counts.push_back(independent);
    variances.emplace_back(squares / count);
  }
  double sum = 0.0;
  for (Eigen::Index a = 0; a < 6; ++a) {
    std::vector<double> of_axis;
    of_axis.reserve(variances.size());
    for (const Vector6d& variance : variances) of_axis.push_back(variance[a]);
    // A coordinate that does not grow is left at a rate far below what can be measured.
    sum += std::log(std::max(slope(seconds, of_axis, counts), 1e-12));
  }
  return sum;
}

double best_distance(const std::vector<RecordingVariances>& all,
                     const std::vector<std::size_t>& chosen) {
  double least = std::numeric_limits<double>::infinity();
  double best = 0.0;
  for (std::size_t d = 0; d < kDistances; ++d) {
    const double value = criterion(all, chosen, d);
    if (value < least) {
      least = value;
      best = kStep * static_cast<double>(d);
    }
  }
  return best;
}

}  // namespace

std::vector<OdometryFrames> odometry_windows(const OdometryRecording& recording, double length) {
  const std::vector<double>& stamps = recording.stamps;
  std::vector<OdometryFrames> windows;
  const double slack = 1e-6 * length;
  double next_start = -std::numeric_limits<double>::infinity();
  std::size_t j = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (stamps[i] < next_start) continue;
    while (j < stamps.size() && stamps[j] < stamps[i] + length - slack) ++j;
    if (j == stamps.size()) break;
    const bool known = recording.odometry[i] && recording.odometry[j] &&
                       recording.camera_truth[i] && recording.camera_truth[j];
    // A gap may not make the window much longer than it is to be.
    if (!known || j == i || stamps[j] > stamps[i] + 1.5 * length) continue;
    next_start = stamps[i] + 0.25 * length - slack;
    windows.push_back({i, j});
  }
  return windows;
}

double independent_windows(const OdometryRecording& recording, std::size_t count, double seconds) {
  const auto n = static_cast<double>(count);
  const double whole = recording.stamps.back() - recording.stamps.front();
  return std::max(1.0, std::min(n, whole / (seconds / n)));
}

Vector6d robust_variances(const std::vector<Vector6d>& errors) {
  constexpr double kMedianOfSquares = 0.45493642311957283;  // of a standard normal number
  Vector6d result;
  std::vector<double> squares(errors.size());
  for (Eigen::Index a = 0; a < 6; ++a) {
    for (std::size_t i = 0; i < errors.size(); ++i) squares[i] = errors[i][a] * errors[i][a];
    result[a] = median(squares) / kMedianOfSquares;
  }
  return result;
}

OdometryRecording at_scene_point(OdometryRecording recording, double distance_m) {
  const SE3d point = point_at(distance_m);
  for (auto& pose : recording.odometry) {
    if (pose) pose = *pose * point;
  }
  for (auto& pose : recording.camera_truth) {
    if (pose) pose = *pose * point;
  }
  return recording;
}

SceneDistance scene_distance(std::span<const OdometryRecording> recordings,
                             const OdometryNoiseSettings& settings) {
  if (settings.scene_distance_m)
    return {*settings.scene_distance_m, std::numeric_limits<double>::quiet_NaN()};
  std::vector<RecordingVariances> all;
  for (const OdometryRecording& recording : recordings) {
    RecordingVariances windows;
    bool any = false;
    for (const double length : settings.windows_s) {
      windows.push_back(window_variances(recording, length));
      any = any || windows.back().count > 0.0;
    }
    if (any) all.push_back(std::move(windows));
  }
  if (all.empty()) return {};
  std::vector<std::size_t> chosen(all.size());
  for (std::size_t r = 0; r < all.size(); ++r) chosen[r] = r;
  SceneDistance result{best_distance(all, chosen), std::numeric_limits<double>::quiet_NaN()};
  if (all.size() < 2 || settings.bootstrap < 2) return result;
  RandomStream stream(settings.seed);
  double sum = 0.0;
  double squares = 0.0;
  for (int sample = 0; sample < settings.bootstrap; ++sample) {
    for (std::size_t& r : chosen) {
      r = std::min(all.size() - 1,
                   static_cast<std::size_t>(stream.uniform() * static_cast<double>(all.size())));
    }
    const double distance = best_distance(all, chosen);
    sum += distance;
    squares += distance * distance;
  }
  const double n = settings.bootstrap;
  result.error_m = std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1.0)));
  return result;
}

}  // namespace posemix::internal
