// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A board that moves before a still camera: 69 s of measurements with a reference by motion capture
// (docs/moving-objects.md, "Measured").
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/base/random.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/filter/moving_object_smoother.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/testing/data.hpp"

namespace posemix {
namespace {

const SE3d kHalfTurn(SO3d::exp({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero());

std::vector<StampedPose> board(const char* name) {
  const auto folder = *testing::data_dir() / "hand-eye-calibration" / "prime_sense_1";
  return parse_tum(read_file_or_gzip(folder / name), name);
}

/// Rotation [deg], position of the board from the camera and of the camera from the board [mm].
struct Errors {
  std::vector<double> degrees;
  std::vector<double> board_mm;
  std::vector<double> camera_mm;

  void add(const SE3d& estimate, const SE3d& reference) {
    degrees.push_back(
        posemix::degrees((estimate.rotation().inverse() * reference.rotation()).angle()));
    board_mm.push_back(1e3 * (estimate.translation() - reference.translation()).norm());
    camera_mm.push_back(
        1e3 * (estimate.inverse().translation() - reference.inverse().translation()).norm());
  }
  void record(const std::string& name) const {
    const auto text = [](const std::vector<double>& values) {
      return fmt::format("{:.2f} / {:.2f}", median(values), quantile(values, 0.99));
    };
    ::testing::Test::RecordProperty(
        name, fmt::format("deg {}, board mm {}, camera mm {}", text(degrees), text(board_mm),
                          text(camera_mm)));
  }
};

/// The detector's noise is the library's default, whose scale is learned from innovations; the
/// acceleration has the largest likelihood of the measurements. Neither knows the reference.
MotionModels motion() {
  Vector6d acceleration;
  acceleration << 0.37, 0.37, 0.37, 0.39, 0.39, 0.39;
  return calm_and_agile({.acceleration_sds = acceleration});
}

/// The default noise with half turns, which have a tenth of the weight and last half a second.
DetectorNoise noise_with_half_turns() {
  const DetectorNoise noise = default_detector_noise();
  std::vector<NoiseComponent> components = noise.components();
  for (const NoiseComponent& component : noise.components()) {
    components.push_back(component);
    components.back().weight *= 0.1 / (1.0 - noise.clutter().weight);
    components.back().offset = kHalfTurn;
  }
  NoiseDependence dependence = noise.dependence();
  dependence.mode_time_s = 0.5;
  return DetectorNoise(components, noise.clutter(), dependence);
}

struct BoardRun {
  Errors filtered;
  Errors smoothed;
  Errors predicted;  ///< over about 100 ms
  Errors held;       ///< the measurement of 100 ms ago
  double nees = 0.0;
  double smoothed_nees = 0.0;
};

/// Per degree of freedom.
double nees_of(const ConcentratedGaussian<SE3d>& world, const SE3d& reference) {
  const Vector6d z = (reference * world.mean().inverse()).log();
  return z.dot(world.covariance().inverse() * z) / 6.0;
}

BoardRun run(const DetectorNoise& noise, const std::vector<StampedPose>& measured,
             const std::vector<StampedPose>& reference) {
  MovingObjectSmoother smoother({noise}, motion());
  const MovingObjectFilter& filter = smoother.filter();
  const double share = 1.0 / static_cast<double>(measured.size());
  BoardRun result;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    Observation observation = observation_of(*measured[i].pose);
    observation.stamp_s = measured[i].stamp;
    smoother.update(observation, exact_camera(SE3d()));
    const auto world = filter.estimate().hypotheses.front().world;
    result.filtered.add(world.mean(), *reference[i].pose);
    result.nees += share * nees_of(world, *reference[i].pose);
    std::size_t later = i + 1;
    while (later < measured.size() && measured[later].stamp < measured[i].stamp + 0.085) ++later;
    if (later == measured.size() || measured[later].stamp > measured[i].stamp + 0.115) continue;
    const auto ahead = filter.estimate_at(measured[later].stamp).hypotheses.front().world;
    result.predicted.add(ahead.mean(), *reference[later].pose);
    result.held.add(*measured[i].pose, *reference[later].pose);
  }
  const std::vector<MovingObjectEstimate> smoothed = smoother.smoothed();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const auto& world = smoothed[i].hypotheses.front().world;
    result.smoothed.add(world.mean(), *reference[i].pose);
    result.smoothed_nees += share * nees_of(world, *reference[i].pose);
  }
  return result;
}

TEST(MovingBoard, IsFilteredBelowTheErrorsOfItsMeasurements) {
  POSEMIX_REQUIRE_DATA();
  const auto measured = board("board_measured.tum.gz");
  const auto reference = board("board_reference.tum.gz");
  Errors raw;
  for (std::size_t i = 0; i < measured.size(); ++i) raw.add(*measured[i].pose, *reference[i].pose);
  const BoardRun result = run(default_detector_noise(), measured, reference);
  raw.record("measured");
  result.filtered.record("filtered");
  result.smoothed.record("smoothed");
  result.predicted.record("predicted");
  result.held.record("held");
  RecordProperty("nees", fmt::format("{:.2f}", result.nees));
  for (const auto& part : {&Errors::degrees, &Errors::board_mm, &Errors::camera_mm}) {
    EXPECT_LT(median(result.filtered.*part), median(raw.*part));
    EXPECT_LT(quantile(result.filtered.*part, 0.99), quantile(raw.*part, 0.99));
    EXPECT_LT(median(result.smoothed.*part), median(result.filtered.*part));
    EXPECT_LT(quantile(result.smoothed.*part, 0.99), quantile(result.filtered.*part, 0.99));
  }
  EXPECT_LT(median(result.predicted.degrees), median(result.held.degrees));
  EXPECT_LT(median(result.predicted.board_mm), median(result.held.board_mm));
  EXPECT_GT(result.nees, 0.5);
  EXPECT_LT(result.nees, 2.0);
  RecordProperty("smoothed_nees", fmt::format("{:.2f}", result.smoothed_nees));
  EXPECT_GT(result.smoothed_nees, 0.5);
  EXPECT_LT(result.smoothed_nees, 2.0);
}

TEST(MovingBoard, IsFilteredAsWellWithHalfTurnsInRuns) {
  POSEMIX_REQUIRE_DATA();
  auto measured = board("board_measured.tum.gz");
  const auto reference = board("board_reference.tum.gz");
  const BoardRun plain = run(default_detector_noise(), measured, reference);
  // Runs of 15 measurements on average, a tenth of all.
  RandomStream stream(5, 1);
  bool turned = false;
  int count = 0;
  for (StampedPose& frame : measured) {
    turned = turned ? stream.uniform() >= 1.0 / 15.0 : stream.uniform() < 1.0 / 135.0;
    if (turned) frame.pose = *frame.pose * kHalfTurn;
    count += turned ? 1 : 0;
  }
  const BoardRun result = run(noise_with_half_turns(), measured, reference);
  result.filtered.record("filtered");
  result.smoothed.record("smoothed");
  RecordProperty("turned", count);
  RecordProperty("nees", fmt::format("{:.2f}", result.nees));
  EXPECT_GT(count, 100);
  for (const auto& part : {&Errors::degrees, &Errors::board_mm, &Errors::camera_mm}) {
    EXPECT_LT(median(result.filtered.*part), 1.1 * median(plain.filtered.*part));
    EXPECT_LT(quantile(result.filtered.*part, 0.99), 1.1 * quantile(plain.filtered.*part, 0.99));
    EXPECT_LT(median(result.smoothed.*part), 1.1 * median(plain.smoothed.*part));
    EXPECT_LT(quantile(result.smoothed.*part, 0.99), 1.1 * quantile(plain.smoothed.*part, 0.99));
  }
}

}  // namespace
}  // namespace posemix
