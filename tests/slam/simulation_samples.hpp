// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "posemix/slam/simulation.hpp"
#include "posemix/testing/statistics.hpp"

/// Small simulations and their errors.
namespace posemix::testing {

using Eigen::Vector3d;

inline constexpr std::size_t kManyFrames = 20'000;
/// Standard errors that a correct statistic with a fixed seed stays within.
inline constexpr double kBound = 5.0;

inline SimulationSd sd_of(const Vector3d& rotation_deg, const Vector3d& translation_m) {
  return {kRadPerDeg * rotation_deg, translation_m};
}

inline SimulationSd small_sd() {
  return sd_of(Vector3d(1.0, 2.0, 4.0), Vector3d(0.003, 0.005, 0.008));
}

inline Matrix6d covariance_of(const SimulationSd& sd) {
  return pose_covariance(sd.rotation_rad, sd.translation_m);
}

inline SimulationObject object_with(std::vector<SimulationNoise> noise, std::string id = "mug") {
  SimulationObject object;
  object.id = std::move(id);
  object.position_m = Vector3d(0.1, -0.2, 0.05);
  object.rotation_rad = Vector3d(0.3, -0.1, 1.2);
  object.noise = std::move(noise);
  return object;
}

inline SimulationConfig config_with(std::vector<SimulationObject> objects, std::size_t frames) {
  SimulationConfig config;
  config.path.frames = frames;
  config.objects = std::move(objects);
  return config;
}

/// Log(T_true^-1 T_detected) of every detection of the first object, with T_true moved by `mode`.
inline std::vector<Vector6d> errors_of(const SimulatedSequence& simulated, const SE3d& mode = {}) {
  std::vector<Vector6d> errors;
  const SimulatedObject& object = simulated.objects.front();
  for (std::size_t k = 0; k < object.detections.size(); ++k) {
    if (!object.detections[k]) continue;
    const SE3d truth = object.relative_truth[k].pose() * mode;
    errors.push_back((truth.inverse() * object.detections[k]->pose()).log());
  }
  return errors;
}

inline SampleMoments moments_of(const std::vector<Vector6d>& errors) {
  SampleMoments moments(6);
  for (const Vector6d& error : errors) moments.add(error);
  return moments;
}

/// Time between two frames of the recordings of `moving` [s].
inline constexpr double kPeriod = 0.02;

/// A recording of one object before a still camera, 50 frames per second.
inline SimulationConfig moving(const SimulationObject& object, double length_s) {
  SimulationConfig config =
      config_with({object}, static_cast<std::size_t>(std::lround(length_s / kPeriod)));
  config.path.period_s = kPeriod;
  config.path.set_up = SimulationSetUp::still;
  return config;
}

inline SimulationObject mug() { return object_with({{1.0, small_sd()}}); }

inline std::size_t frame_at(double time_s) {
  return static_cast<std::size_t>(std::lround(time_s / kPeriod));
}

}  // namespace posemix::testing
