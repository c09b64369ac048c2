// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/slam/simulation.hpp"

/// Checks of the settings of a simulation.
namespace posemix::internal::simulation {

inline constexpr std::size_t kMostFrames = 10'000'000;
inline constexpr double kLongestPeriod = 3600.0;  // seconds
inline constexpr double kSmallestWeight = 1e-12;
inline constexpr double kLargestWeight = 1e12;
inline constexpr double kFurthest = 1e3;      // metres
inline constexpr double kLargestAngle = 1e3;  // radians

/// Checks numbers and remembers whose they are.
class Checker {
 public:
  explicit Checker(std::string owner) : owner_(std::move(owner)) {}

  void within(double value, double lowest, double highest, const char* name) const {
    if (value >= lowest && value <= highest) return;
    throw InvalidInput(fmt::format("simulation: {} {} is {}, expected a number in [{:g}, {:g}]",
                                   owner_, name, value, lowest, highest));
  }
  void within(const Eigen::Vector3d& values, double lowest, double highest,
              const char* name) const {
    for (const double value : values) within(value, lowest, highest, name);
  }
  void sd(const SimulationSd& sd) const {
    within(sd.rotation_rad, 0.0, kLargestAngle, "standard deviation of rotation");
    within(sd.translation_m, 0.0, kFurthest, "standard deviation of translation");
  }
  void runs(const SimulationRuns& runs, const char* name) const {
    within(runs.fraction, 0.0, 1.0, name);
    within(runs.mean_run_s, 0.0, std::numeric_limits<double>::max(), "mean run");
  }
  void slow(const SimulationSlowError& slow) const {
    sd(slow.sd);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr double kLeast = 1e-9;
    within(slow.correlation_s, kLeast, kInfinity, "correlation time of the slow error");
    within(slow.correlation_angle_rad, kLeast, kInfinity, "correlation angle of the slow error");
  }
  void noise(const SimulationNoise& noise) const {
    within(noise.weight, kSmallestWeight, kLargestWeight, "weight of noise");
    sd(noise.sd);
    within(noise.offset_rotation_rad, -kLargestAngle, kLargestAngle, "offset rotation");
    within(noise.offset_translation_m, -kFurthest, kFurthest, "offset translation");
  }

 private:
  std::string owner_;
};

/// @throws InvalidInput for settings of the image, of motions, frames and clutter, and unless what
/// they name is there
void check_scene(const SimulationConfig& config);

}  // namespace posemix::internal::simulation
