// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "posemix/slam/simulation.hpp"
#include "simulation_random.hpp"

/// What is in the image of a simulated camera.
namespace posemix::internal::simulation {

/// Whether a point is in the image and the range; T_camera_object has it as its translation.
bool is_in_view(const std::optional<SimulationView>& view, const Vector3& point);

/// The false detections of one table of clutter, frame by frame.
class ClutterSource {
 public:
  /// @param index of the table, which names its random streams
  ClutterSource(const SimulationClutter& clutter, const std::optional<SimulationView>& view,
                std::size_t index, double period_s, std::uint64_t seed);

  /// T_camera_object of the false detections in the next frame.
  std::vector<Pose> next(const Pose& world_camera);

 private:
  Pose anywhere();

  SimulationClutter clutter_;
  std::optional<SimulationView> view_;
  RandomStream random_;
  std::vector<StickyChain> places_;
  std::vector<RandomStream> errors_;
};

/// Two states, 0 (off) and 1 (on). A run of `on` ends with probability (1 - keep)(1 - fraction).
StickyChain run_chain(const SimulationRuns& runs, double period_s, RandomStream random);

/// n with standard deviations, rotation first.
Vector6 draw_error(const SimulationSd& sd, RandomStream& random);

}  // namespace posemix::internal::simulation
