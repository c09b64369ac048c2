// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/odometry_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"
#include "posemix/base/statistics.hpp"

namespace posemix {
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

/// Of the square of a standard normal number.
constexpr double kMedianOfSquares = 0.45493642311957283;

Matrix6d squared_adjoint(const SE3d& pose) { return pose.adjoint().cwiseAbs2(); }

/// The windows of about `length` seconds of one recording; they begin a quarter of it apart.
// One stage after the other, and nothing of them stands alone.
// NOLINTNEXTLINE(readability-function-size)
WindowSums window_sums(const OdometryRecording& recording, double length) {
  const std::vector<double>& stamps = recording.stamps;
  WindowSums sums;
  std::array<std::vector<double>, 6> squares;
  double next_start = -std::numeric_limits<double>::infinity();
  std::size_t j = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (stamps[i] < next_start) continue;
    const double slack = 1e-6 * length;
    while (j < stamps.size() && stamps[j] < stamps[i] + length - slack) ++j;
    if (j == stamps.size()) break;
    const bool known = recording.odometry[i] && recording.odometry[j] &&
                       recording.camera_truth[i] && recording.camera_truth[j];
    // A gap may not make the window much longer than it is to be.
    if (!known || j == i || stamps[j] > stamps[i] + 1.5 * length) continue;
    next_start = stamps[i] + 0.25 * length - slack;
    const SE3d motion = recording.odometry[i]->inverse() * *recording.odometry[j];
    const SE3d truth = recording.camera_truth[i]->inverse() * *recording.camera_truth[j];
    const Vector6d error = (truth.inverse() * motion).log();
    sums.count += 1.0;
    sums.seconds += stamps[j] - stamps[i];
    for (std::size_t a = 0; a < 6; ++a)
      squares[a].push_back(std::pow(error[static_cast<Eigen::Index>(a)], 2));
    double at = stamps[i];
    for (std::size_t t = i + 1; t <= j; ++t) {
      if (!recording.odometry[t]) continue;  // the next pose counts for both steps
      sums.model.leftCols<6>() +=
          (stamps[t] - at) *
          squared_adjoint(recording.odometry[j]->inverse() * *recording.odometry[t]);
      at = stamps[t];
    }
    sums.model.rightCols<6>() += Matrix6d::Identity() + squared_adjoint(motion.inverse());
  }
  if (sums.count > 0.0) {
    for (std::size_t a = 0; a < 6; ++a)
      sums.squares[static_cast<Eigen::Index>(a)] =
          sums.count * median(squares[a]) / kMedianOfSquares;
    const double mean = sums.seconds / sums.count;
    sums.independent = std::max(1.0, std::min(sums.count, (stamps.back() - stamps.front()) / mean));
  }
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

}  // namespace

OdometryNoise fit_odometry_noise(std::span<const OdometryRecording> recordings,
                                 const OdometryNoiseSettings& settings) {
  AllSums sums;
  for (const OdometryRecording& recording : recordings) {
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
                      .recordings = sums.size()};
  for (const WindowSums& w : total) {
    if (w.count == 0.0) continue;
    noise.windows.push_back(
        {w.seconds / w.count, w.independent, w.squares / w.count, w.model * theta / w.count});
  }
  return noise;
}

}  // namespace posemix
