// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/slam/simulation.hpp"

/// Object SLAM with its default settings on simulated recordings with the errors of real detectors.
namespace posemix {
namespace {

SimulationObject object(const std::string& id, const Eigen::Vector3d& position) {
  SimulationObject result;
  result.id = id;
  result.position_m = position;
  result.noise = {SimulationNoise{
      .weight = 1.0,
      .sd = {Eigen::Vector3d(4.0, 4.0, 2.0) * kRadPerDeg, Eigen::Vector3d(0.005, 0.005, 0.02)},
      .frame = NoiseFrame::camera}};
  result.correlation_s = 0.3;
  result.outliers = {.runs = {.fraction = 0.15, .mean_run_s = 1.2}};
  result.misses = {.fraction = 0.1, .mean_run_s = 0.2};
  return result;
}

/// Five objects: two flip (one for long), two come late, one only errs.
SimulationConfig table() {
  SimulationConfig config;
  config.path.frames = 400;
  config.path.range = {1.0, 0.15, 3};
  config.objects = {object("plain", {0.0, 0.0, 0.05}), object("flips", {0.2, 0.1, 0.05}),
                    object("flips_long", {-0.2, 0.1, 0.05}), object("late", {0.1, -0.2, 0.05}),
                    object("late_flips", {-0.15, -0.15, 0.05})};
  const Eigen::Vector3d half_turn(0.0, 0.0, std::numbers::pi);
  config.objects[1].flips = {.runs = {.fraction = 0.3, .mean_run_s = 0.3},
                             .rotation_rad = half_turn};
  config.objects[2].flips = {.runs = {.fraction = 0.25, .mean_run_s = 2.5},
                             .rotation_rad = half_turn};
  config.objects[3].hidden_frames = 150;
  config.objects[4].hidden_frames = 200;
  config.objects[4].flips = config.objects[1].flips;
  return config;
}

TEST(MultiObjectSimulation, TheRightModeLeadsAtTheEnd) {
  const SimulationConfig config = table();
  constexpr int kSeeds = 100;
  std::size_t right = 0;
  std::size_t objects = 0;
  double seconds = 0.0;
  std::size_t frames = 0;
  double camera = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const SimulatedSequence simulated = simulate(config, static_cast<std::uint64_t>(seed));
    const Sequence sequence = simulated.sequence();
    std::vector<ObjectModel> models;
    for (const SimulationObject& one : config.objects) models.push_back({.id = one.id});
    ObjectSlamSettings settings;
    settings.motion = motion_settings(config);
    const SlamRun result = run(sequence, camera_prior(config, simulated), models, settings);
    const FrameEstimate& last = result.frames.back();
    for (std::size_t j = 0; j < models.size(); ++j) {
      ++objects;
      const auto truth = true_relative_pose(sequence, j, sequence.stamps.size() - 1);
      right += last.relative[j] && on_right_mode(last.relative[j]->mean(), *truth) ? 1 : 0;
    }
    for (const FrameEstimate& frame : result.frames) seconds += frame.report.seconds;
    frames += result.frames.size();
    const Metrics metrics = evaluate(sequence, result);
    camera += std::log(*metrics.camera.rotation_rmse_deg / *metrics.odometry.rotation_rmse_deg);
  }
  std::printf("right mode at the end: %zu of %zu; %.0f us per frame; camera over odometry %.3f\n",
              right, objects, 1e6 * seconds / static_cast<double>(frames),
              std::exp(camera / kSeeds));
  EXPECT_GE(static_cast<double>(right), 0.97 * static_cast<double>(objects));
  EXPECT_LE(std::exp(camera / kSeeds), 1.02);
}

}  // namespace
}  // namespace posemix
