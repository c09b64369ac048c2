// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "posemix/slam/simulation.hpp"
#include "simulation_checks.hpp"

/// Settings of the simulation: their checks, and what the filter is told of them.
namespace posemix {
namespace {

using namespace internal::simulation;

void check(const SimulationPath& path) {
  const Checker checker("path");
  checker.within(static_cast<double>(path.frames), 1, kMostFrames, "frames");
  checker.within(path.period_s, 1e-9, kLongestPeriod, "period");
  checker.within(path.target_m, -kFurthest, kFurthest, "target");
  checker.within(path.range.mean_m, 0.0, kFurthest, "range");
  checker.within(path.range.swing_m, -kFurthest, kFurthest, "swing of the range");
  checker.within(path.height.mean_m, -kFurthest, kFurthest, "height");
  checker.within(path.height.swing_m, -kFurthest, kFurthest, "swing of the height");
  const double nearest = path.range.mean_m - std::abs(path.range.swing_m);
  const double highest = std::abs(path.height.mean_m) + std::abs(path.height.swing_m);
  if (!(nearest > highest)) {
    throw InvalidInput(fmt::format(
        "simulation: path: the smallest range, {} m, must exceed the largest height, {} m", nearest,
        highest));
  }
}

/// The frame of all components, if they have one.
std::optional<NoiseFrame> frame_of(const std::vector<SimulationNoise>& components) {
  const NoiseFrame frame = components.front().frame;
  const bool same = std::ranges::all_of(
      components, [&](const SimulationNoise& noise) { return noise.frame == frame; });
  return same ? std::optional(frame) : std::nullopt;
}

/// A slow error is along the axes of the components, whichever is drawn.
void check_frames(const SimulationObject& object) {
  const auto frame = frame_of(object.noise);
  if (frame && (object.claimed.empty() || frame == frame_of(object.claimed))) return;
  throw InvalidInput(fmt::format(
      "simulation: object '{}' has components of different frames, of 'noise' or 'claimed_noise', "
      "expected one frame beside a slow error",
      object.id));
}

void check(const SimulationObject& object, std::size_t frames) {
  if (object.id.empty()) throw InvalidInput("simulation: an object has no id");
  const Checker checker(fmt::format("object '{}':", object.id));
  checker.within(object.position_m, -kFurthest, kFurthest, "position");
  checker.within(object.rotation_rad, -kLargestAngle, kLargestAngle, "rotation");
  if (object.noise.empty()) {
    throw InvalidInput(
        fmt::format("simulation: object '{}': there is no noise component", object.id));
  }
  for (const SimulationNoise& noise : object.noise) checker.noise(noise);
  for (const SimulationNoise& noise : object.claimed) checker.noise(noise);
  checker.within(object.correlation_s, 0.0, std::numeric_limits<double>::max(), "correlation time");
  if (object.slow) {
    checker.slow(*object.slow);
    check_frames(object);
  }
  checker.runs(object.flips.runs, "fraction of flips");
  checker.within(object.flips.rotation_rad, -kLargestAngle, kLargestAngle, "flip rotation");
  checker.within(object.flips.translation_m, -kFurthest, kFurthest, "flip translation");
  checker.runs(object.outliers.runs, "fraction of outliers");
  checker.within(object.outliers.box_m, 0.0, kFurthest, "box of outliers");
  checker.runs(object.misses, "fraction of misses");
  if (object.hidden_frames >= frames) {
    throw InvalidInput(fmt::format("simulation: object '{}' is hidden for {} of {} frames",
                                   object.id, object.hidden_frames, frames));
  }
}

Matrix6d covariance_of(const SimulationSd& sd) {
  return pose_covariance(sd.rotation_rad, sd.translation_m);
}

SE3d offset_of(const SimulationNoise& noise) {
  return {SO3d::exp(noise.offset_rotation_rad), noise.offset_translation_m};
}

}  // namespace

void validate(const SimulationConfig& config) {
  check(config.path);
  Checker("odometry").sd(config.odometry);
  if (config.claimed_odometry) Checker("claimed odometry").sd(*config.claimed_odometry);
  Checker("start").sd(config.start);
  std::set<std::string> ids;
  for (const SimulationObject& object : config.objects) {
    check(object, config.path.frames);
    if (!ids.insert(object.id).second) {
      throw InvalidInput(fmt::format("simulation: object id '{}' occurs twice", object.id));
    }
  }
  check_scene(config);
  std::vector<ObjectModel> models;
  models.reserve(config.objects.size());
  for (const SimulationObject& object : config.objects) models.push_back(object_model(object));
  require_alike_in_class(models);
}

namespace {

/// The least standard deviations of all components, by axis.
SimulationSd least_sd(const std::vector<SimulationNoise>& components) {
  SimulationSd least = components.front().sd;
  for (const SimulationNoise& noise : components) {
    least.rotation_rad = least.rotation_rad.cwiseMin(noise.sd.rotation_rad);
    least.translation_m = least.translation_m.cwiseMin(noise.sd.translation_m);
  }
  return least;
}

/// The components of the whole error.
std::vector<SimulationNoise> claimed_components(const SimulationObject& object) {
  if (!object.claimed.empty()) return object.claimed;
  double total = 0.0;
  for (const SimulationNoise& noise : object.noise) total += noise.weight;
  const double flipped = object.flips.runs.fraction;
  const SE3d flip(SO3d::exp(object.flips.rotation_rad), object.flips.translation_m);
  std::vector<SimulationNoise> components;
  for (SimulationNoise noise : object.noise) {
    noise.weight *= (1.0 - flipped) / total;
    if (noise.weight > 0.0) components.push_back(noise);
  }
  for (SimulationNoise noise : object.noise) {
    noise.weight *= flipped / total;
    const SE3d offset = flip * offset_of(noise);
    noise.offset_rotation_rad = offset.rotation().log();
    noise.offset_translation_m = offset.translation();
    if (noise.weight > 0.0) components.push_back(noise);
  }
  return components;
}

/// The slow error as a filter can be told it: none where all of it is zero, and else with a
/// deviation along every axis, for its covariance must be regular.
std::optional<SimulationSlowError> regular(SimulationSlowError slow) {
  constexpr double kLeastSd = 1e-6;  // rad and m, or a fraction of the range
  SimulationSd& sd = slow.sd;
  if (sd.rotation_rad.isZero(0.0) && sd.translation_m.isZero(0.0)) return std::nullopt;
  sd.rotation_rad = sd.rotation_rad.cwiseMax(kLeastSd);
  sd.translation_m = sd.translation_m.cwiseMax(kLeastSd);
  return slow;
}

}  // namespace

std::optional<SimulationSlowError> claimed_slow_error(const SimulationObject& object) {
  // A white part of a tenth keeps the noise of the filter regular where there is none.
  constexpr double kSlowFraction = 0.9;
  if (object.slow) return regular(*object.slow);
  if (!(object.correlation_s > 0.0)) return std::nullopt;
  const std::vector<SimulationNoise> components = claimed_components(object);
  if (!frame_of(components)) return std::nullopt;
  SimulationSlowError slow{least_sd(components), object.correlation_s};
  slow.sd.rotation_rad *= std::sqrt(kSlowFraction);
  slow.sd.translation_m *= std::sqrt(kSlowFraction);
  return slow;
}

std::vector<SimulationNoise> claimed_noise(const SimulationObject& object) {
  std::vector<SimulationNoise> components = claimed_components(object);
  const auto slow = claimed_slow_error(object);
  if (!slow || object.slow) return components;
  const auto without = [](const Eigen::Vector3d& sd, const Eigen::Vector3d& part) {
    return Eigen::Vector3d((sd.array().square() - part.array().square()).sqrt());
  };
  for (SimulationNoise& noise : components) {
    noise.sd.rotation_rad = without(noise.sd.rotation_rad, slow->sd.rotation_rad);
    noise.sd.translation_m = without(noise.sd.translation_m, slow->sd.translation_m);
  }
  return components;
}

double claimed_mode_time_s(const SimulationObject& object) {
  const auto run = [](const SimulationRuns& runs) {
    return runs.fraction > 0.0 ? runs.mean_run_s : 0.0;
  };
  const double components = object.noise.size() > 1 ? object.correlation_s : 0.0;
  return std::max({run(object.flips.runs), run(object.outliers.runs), components});
}

Clutter claimed_clutter(const SimulationObject& object) {
  const double fraction = object.outliers.runs.fraction;
  return {.weight = fraction < 1.0 ? fraction / (1.0 - fraction) : 1.0, .volume_m3 = 1.0};
}

ObjectModel object_model(const SimulationObject& object) {
  std::vector<NoiseComponent> components;
  for (const SimulationNoise& noise : claimed_noise(object)) {
    components.push_back({noise.weight, covariance_of(noise.sd), noise.frame, offset_of(noise)});
  }
  NoiseDependence dependence;
  dependence.mode_time_s = claimed_mode_time_s(object);
  if (const auto slow = claimed_slow_error(object)) {
    dependence.slow =
        SlowError{covariance_of(slow->sd), slow->correlation_s, slow->correlation_angle_rad};
  }
  return {object.id,
          DetectorNoise(std::move(components), claimed_clutter(object), dependence),
          {},
          {},
          object.class_id};
}

SimulationSd claimed_camera_error(const SimulationConfig& config) {
  if (config.claimed_odometry) return *config.claimed_odometry;
  return config.path.set_up == SimulationSetUp::on_arm ? config.path.arm : config.odometry;
}

MotionSettings motion_settings(const SimulationConfig& config) {
  MotionSettings motion;
  if (config.path.set_up == SimulationSetUp::still) motion.model = MotionModel::still;
  if (config.path.set_up == SimulationSetUp::on_arm) motion.model = MotionModel::given;
  motion.noise.covariance = covariance_of(claimed_camera_error(config));
  motion.noise.per = NoisePer::second;
  return motion;
}

SimulationSd claimed_start(const SimulationConfig& config, const SimulatedSequence& simulated) {
  if (config.path.set_up != SimulationSetUp::on_arm) return config.start;
  // A turn about the camera moves it as seen from the world's origin; along every axis at most so.
  const SimulationSd& arm = config.path.arm;
  const double turn = arm.rotation_rad.maxCoeff();
  const double lever = simulated.camera_start.pose().translation().norm();
  return {Eigen::Vector3d::Constant(turn),
          Eigen::Vector3d::Constant(std::hypot(arm.translation_m.maxCoeff(), lever * turn))};
}

ConcentratedGaussian<SE3d> camera_prior(const SimulationConfig& config,
                                        const SimulatedSequence& simulated) {
  return {simulated.camera_start.pose(), covariance_of(claimed_start(config, simulated))};
}

}  // namespace posemix
