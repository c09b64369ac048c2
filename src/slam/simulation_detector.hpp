// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "posemix/slam/simulation.hpp"
#include "simulation_random.hpp"

namespace posemix::internal::simulation {

/// The detector of one object, frame by frame.
class Detector {
 public:
  Detector(const SimulationObject& object, double period_s, std::uint64_t seed);

  /// The detection in the next frame; `truth` is T_camera_object.
  std::optional<Pose> next(const Pose& truth);

 private:
  struct Mode {
    NoiseFrame frame;
    Vector6 sd;
    Pose offset;
  };

  /// b at this frame, moved on by the change of view.
  Vector6 slow_error(const Pose& truth);

  std::vector<Mode> modes_;
  Pose flip_;
  Vector3 box_;
  std::size_t hidden_frames_;
  std::size_t frame_ = 0;
  std::optional<SimulationSlowError> slow_;
  double period_s_;
  RandomStream slow_random_;
  std::optional<Vector3> view_;  ///< direction to the camera in the frame before, object frame
  Vector6 slow_state_ = Vector6::Zero();
  StickyChain component_;
  CorrelatedNormal normal_;
  StickyChain flips_;
  StickyChain outliers_;
  StickyChain misses_;
  RandomStream wrong_poses_;
  std::optional<Pose> wrong_;  ///< in a run of outliers
};

}  // namespace posemix::internal::simulation
