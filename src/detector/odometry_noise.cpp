// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/odometry_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/limits.hpp"
#include "posemix/base/random.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "scene_distance.hpp"

namespace posemix {

using namespace internal;

namespace {

using Vector12d = Eigen::Matrix<double, 12, 1>;
/// Of each coordinate of an error, what the entries of Q and then of J add to its variance.
using VarianceModel = Eigen::Matrix<double, 6, 12>;

/// Sums over the windows of one length in a recording.
struct WindowSums {
  double count = 0.0;                   ///< windows
  double seconds = 0.0;                 ///< sum of their lengths
  double independent = 0.0;             ///< windows that do not overlap
  Vector6d squares = Vector6d::Zero();  ///< count times the variance
  VarianceModel model = VarianceModel::Zero();

  void add(const WindowSums& other) {
    count += other.count;
    seconds += other.seconds;
    independent += other.independent;
    squares += other.squares;
    model += other.model;
  }
};

Matrix6d squared_adjoint(const SE3d& pose) { return pose.adjoint().cwiseAbs2(); }

/// The error of the relative pose over each window.
Vector6d error_over(const OdometryRecording& recording, const OdometryFrames& window) {
  const auto [i, j] = window;
  const SE3d motion = recording.odometry[i]->inverse() * *recording.odometry[j];
  const SE3d truth = recording.camera_truth[i]->inverse() * *recording.camera_truth[j];
  return (truth.inverse() * motion).log();
}

/// What the entries of Q and J add to the variances of the error over a window.
VarianceModel variance_model(const OdometryRecording& recording, const OdometryFrames& window) {
  const auto [i, j] = window;
  VarianceModel model = VarianceModel::Zero();
  double at = recording.stamps[i];
  for (std::size_t t = i + 1; t <= j; ++t) {
    if (!recording.odometry[t]) continue;  // the next pose counts for both steps
    model.leftCols<6>() +=
        (recording.stamps[t] - at) *
        squared_adjoint(recording.odometry[j]->inverse() * *recording.odometry[t]);
    at = recording.stamps[t];
  }
  const SE3d motion = recording.odometry[i]->inverse() * *recording.odometry[j];
  model.rightCols<6>() = Matrix6d::Identity() + squared_adjoint(motion.inverse());
  return model;
}

WindowSums window_sums(const OdometryRecording& recording, double length) {
  WindowSums sums;
  std::vector<Vector6d> errors;
  for (const OdometryFrames& window : odometry_windows(recording, length)) {
    errors.push_back(error_over(recording, window));
    sums.count += 1.0;
    sums.seconds += recording.stamps[window.last] - recording.stamps[window.first];
    sums.model += variance_model(recording, window);
  }
  if (errors.empty()) return sums;
  sums.squares = sums.count * robust_variances(errors);
  sums.independent = independent_windows(recording, errors.size(), sums.seconds);
  return sums;
}

/// By recording, by window.
using AllSums = std::vector<std::vector<WindowSums>>;

std::vector<WindowSums> pooled(const AllSums& recordings, const std::vector<std::size_t>& chosen) {
  std::vector<WindowSums> total(recordings.front().size());
  for (const std::size_t r : chosen) {
    for (std::size_t w = 0; w < total.size(); ++w) total[w].add(recordings[r][w]);
  }
  return total;
}

/// The likelihood of the mean squares less what does not depend on the variances, times -2.
double deviance(const std::vector<WindowSums>& windows, const Vector12d& theta) {
  double sum = 0.0;
  for (const WindowSums& w : windows) {
    if (w.count == 0.0) continue;
    const Vector6d fitted = w.model * theta;
    sum += w.independent *
           (w.squares.array() / fitted.array() - (w.squares.array() / fitted.array()).log()).sum();
  }
  return sum;
}

Vector12d variance_step(const std::vector<WindowSums>& windows, const Vector12d& theta) {
  Vector12d up = Vector12d::Zero();
  Vector12d down = Vector12d::Zero();
  for (const WindowSums& w : windows) {
    if (w.count == 0.0) continue;
    const Vector6d fitted = w.model * theta;
    const Vector6d by = w.independent * fitted.cwiseInverse();
    up += w.model.transpose() * by.cwiseProduct(w.squares).cwiseQuotient(fitted);
    down += w.model.transpose() * by;
  }
  return theta.cwiseProduct(up.cwiseQuotient(down).cwiseSqrt()).cwiseMax(1e-300);
}

/// A start of the right size: all of the variance is that of either kind.
Vector12d start_variances(const std::vector<WindowSums>& windows) {
  Vector12d theta = Vector12d::Constant(1e-30);
  for (const WindowSums& w : windows) {
    if (w.count == 0.0) continue;
    for (Eigen::Index a = 0; a < 6; ++a) {
      theta[a] = std::max(theta[a], w.squares[a] / w.model(a, a));
      theta[6 + a] = std::max(theta[6 + a], w.squares[a] / w.model(a, 6 + a));
    }
  }
  return theta;
}

/// The entries of Q and J.
Vector12d fit_variances(const std::vector<WindowSums>& windows) {
  constexpr int kRounds = 200;
  constexpr int kStepsPerRound = 50;
  Vector12d theta = start_variances(windows);
  double before = deviance(windows, theta);
  for (int round = 0; round < kRounds; ++round) {
    for (int step = 0; step < kStepsPerRound; ++step) theta = variance_step(windows, theta);
    const double now = deviance(windows, theta);
    if (before - now < 1e-6) break;
    before = now;
  }
  return theta;
}

/// Standard deviations over samples of recordings.
Vector12d bootstrap_errors(const AllSums& recordings, const OdometryNoiseSettings& settings) {
  const std::size_t count = recordings.size();
  if (count < 2 || settings.bootstrap < 2)
    return Vector12d::Constant(std::numeric_limits<double>::quiet_NaN());
  RandomStream stream(settings.seed);
  Vector12d sum = Vector12d::Zero();
  Vector12d squares = Vector12d::Zero();
  for (int sample = 0; sample < settings.bootstrap; ++sample) {
    std::vector<std::size_t> chosen;
    chosen.reserve(count);
    for (std::size_t r = 0; r < count; ++r) {
      chosen.push_back(std::min(
          count - 1, static_cast<std::size_t>(stream.uniform() * static_cast<double>(count))));
    }
    const Vector12d sd = fit_variances(pooled(recordings, chosen)).cwiseSqrt();
    sum += sd;
    squares += sd.cwiseAbs2();
  }
  const double n = settings.bootstrap;
  return ((squares - sum.cwiseAbs2() / n) / (n - 1.0)).cwiseMax(0.0).cwiseSqrt();
}

void check(const OdometryRecording& recording) {
  const std::size_t frames = recording.stamps.size();
  if (recording.odometry.size() != frames || recording.camera_truth.size() != frames)
    throw InvalidInput(fmt::format(
        "odometry noise: recording '{}' has {} stamps, {} poses of the odometry and {} of the "
        "camera's truth, expected as many of each",
        recording.name, frames, recording.odometry.size(), recording.camera_truth.size()));
  for (std::size_t k = 0; k < frames; ++k) {
    kStamp.check(recording.stamps[k], "odometry noise: a stamp");
    if (k > 0 && recording.stamps[k] < recording.stamps[k - 1])
      throw InvalidInput(fmt::format(
          "odometry noise: the stamps of recording '{}' decrease at frame {}", recording.name, k));
    if (recording.odometry[k]) check_pose(*recording.odometry[k], "a pose of the odometry");
    if (recording.camera_truth[k]) check_pose(*recording.camera_truth[k], "a pose of the camera");
  }
}

void check(const OdometryNoiseSettings& settings) {
  for (const double length : settings.windows_s)
    kPositive.check(length, "odometry noise: a length of windows_s");
  if (settings.scene_distance_m)
    kNotNegative.check(*settings.scene_distance_m, "odometry noise: scene_distance_m");
}

}  // namespace

OdometryNoise fit_odometry_noise(std::span<const OdometryRecording> recordings,
                                 const OdometryNoiseSettings& settings) {
  check(settings);
  for (const OdometryRecording& recording : recordings) check(recording);
  const SceneDistance scene = scene_distance(recordings, settings);
  AllSums sums;
  for (const OdometryRecording& at_camera : recordings) {
    const OdometryRecording recording = at_scene_point(at_camera, scene.distance_m);
    std::vector<WindowSums> windows;
    double count = 0.0;
    for (const double length : settings.windows_s) {
      windows.push_back(window_sums(recording, length));
      count += windows.back().count;
    }
    if (count > 0.0) sums.push_back(std::move(windows));
  }
  require(!sums.empty(), "odometry noise: no recording has odometry with the camera's truth");
  std::vector<std::size_t> all(sums.size());
  for (std::size_t r = 0; r < all.size(); ++r) all[r] = r;
  const std::vector<WindowSums> total = pooled(sums, all);
  const Vector12d theta = fit_variances(total);
  const Vector12d errors = bootstrap_errors(sums, settings);
  OdometryNoise noise{.sd_per_sqrt_s = theta.head<6>().cwiseSqrt(),
                      .jitter_sd = theta.tail<6>().cwiseSqrt(),
                      .sd_per_sqrt_s_error = errors.head<6>(),
                      .jitter_sd_error = errors.tail<6>(),
                      .windows = {},
                      .recordings = sums.size(),
                      .scene_distance_m = scene.distance_m,
                      .scene_distance_error_m = scene.error_m};
  for (const WindowSums& w : total) {
    if (w.count == 0.0) continue;
    noise.windows.push_back(
        {w.seconds / w.count, w.independent, w.squares / w.count, w.model * theta / w.count});
  }
  return noise;
}

}  // namespace posemix
