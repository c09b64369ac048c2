// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// One sighting by the multi-object filter: a prediction and one detection of one of N landmarks
// that are all known, on a filter that goes on from pass to pass. The landmarks are seen one after
// the other, over and over, where `local` is zero: every sighting is of the one that was not seen
// for longest, the worst order there is. Else the camera stays with ten of them for a hundred
// sightings and goes on. Where `flips` is one, two of five detections are of another mode, as of a
// tag that is seen face on, so that the modes of many landmarks compete. Time is the mean;
// the counters have the worst, and the memory that the filter holds.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <ctime>
#include <numbers>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix {
namespace {

Vector6d white(RandomStream& stream) {
  Eigen::VectorXd values(6);
  stream.fill_normal(values);
  return values;
}

const Matrix6d& detection_covariance() {
  static const Matrix6d covariance =
      pose_covariance(Eigen::Vector3d::Constant(radians(1.0)), {0.004, 0.004, 0.012});
  return covariance;
}

ObjectSensor sensor(bool has_slow) {
  NoiseDependence dependence;
  if (has_slow)
    dependence.slow =
        SlowError{.covariance = 0.5 * detection_covariance(), .correlation_time_s = 1.0};
  return {DetectorNoise({{.weight = 0.95, .covariance = detection_covariance()}},
                        {.weight = 0.05, .volume_m3 = 10.0}, dependence)};
}

double held_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

/// Time of this thread alone, so that other programs do not count.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A camera that wanders before a wall of landmarks.
class Wall {
 public:
  Wall(std::size_t landmarks, bool has_slow, double flips)
      : flips_(flips),
        before_(held_bytes()),
        filter_(ConcentratedGaussian<SE3d>(SE3d(), q_),
                std::vector<ObjectSensor>(landmarks, sensor(has_slow)), settings()) {
    for (std::size_t j = 0; j < landmarks; ++j) {
      landmarks_.emplace_back(SO3d::exp(0.3 * white(stream_).head<3>()),
                              Eigen::Vector3d(0.3 * static_cast<double>(j % 20),
                                              0.3 * static_cast<double>(j / 20), 2.0));
    }
    for (int pass = 0; pass < 3; ++pass) {
      for (std::size_t j = 0; j < landmarks; ++j) see(j, 0.0);
    }
  }

  /// Returns the seconds that it took.
  double see(std::size_t j, double flips) {
    const SE3d motion(SO3d::exp(1e-3 * white(stream_).head<3>()), 1e-3 * white(stream_).head<3>());
    camera_ = camera_ * motion;
    const SE3d odometry = motion * SE3d::exp(5e-4 * white(stream_));
    SE3d seen = camera_.inverse() * landmarks_[j];
    if (stream_.uniform() < flips)
      seen = seen * SE3d(SO3d::exp({0.0, 2.0, 0.0}), Eigen::Vector3d::Zero());
    const Vector6d deviations = detection_covariance().diagonal().cwiseSqrt();
    seen = seen * SE3d::exp(deviations.cwiseProduct(white(stream_)));
    const double start = cpu_seconds();
    filter_.predict_with_odometry(odometry, q_, 0.03);
    filter_.update(j, seen);
    return cpu_seconds() - start;
  }
  double see(std::size_t j) { return see(j, flips_); }
  double reports() const {
    const double start = cpu_seconds();
    benchmark::DoNotOptimize(filter_.leading_estimates());
    return cpu_seconds() - start;
  }

  double bytes() const { return held_bytes() - before_; }

 private:
  static MultiObjectSettings settings() {
    MultiObjectSettings s;
    s.noise_scale_detections = 1e9;
    return s;
  }

  RandomStream stream_{1, 1};
  Matrix6d q_ = 2.5e-7 * Matrix6d::Identity();
  double flips_;
  double before_;
  SE3d camera_;
  std::vector<SE3d> landmarks_;
  MultiObjectFilter filter_;
};

void landmark_sighting(benchmark::State& state) {
  const auto landmarks = static_cast<std::size_t>(state.range(0));
  const bool is_local = state.range(3) != 0;
  Wall wall(landmarks, state.range(2) != 0, state.range(1) != 0 ? 0.4 : 0.0);
  double worst = 0.0;
  std::size_t k = 0;
  for (auto _ : state) {
    const std::size_t j = is_local ? k / 100 * 10 + k % 10 : k;
    const double seconds = wall.see(j % landmarks);
    state.SetIterationTime(seconds);
    worst = std::max(worst, seconds);
    ++k;
  }
  state.counters["worst_us"] = 1e6 * worst;
  state.counters["report_us"] = 1e6 * wall.reports();
  state.counters["MB"] = 1e-6 * wall.bytes();
}

BENCHMARK(landmark_sighting)
    ->ArgNames({"landmarks", "flips", "slow", "local"})
    ->ArgsProduct({{1, 5, 10, 30, 100, 300}, {0, 1}, {0, 1}, {0, 1}})
    ->Iterations(1000)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace posemix
