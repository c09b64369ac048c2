// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "posemix/slam/simulation.hpp"
#include "simulation_random.hpp"

/// Poses of a simulation over continuous time.
namespace posemix::internal::simulation {

Pose pose_of(const Eigen::Vector3d& rotation_rad, const Eigen::Vector3d& translation_m);

/// A pose for every time in seconds.
using Motion = std::function<Pose(Real)>;
using Motions = std::map<std::string, Motion>;

/// T_world_frame of a frame that goes from waypoint to waypoint.
Motion frame_motion(const SimulationFrame& frame);

/// Random motion in a hand: T_world_object, at `start` until the first time.
Motion hand_motion(const SimulationHandHeld& hand, const Pose& start, double end_s,
                   RandomStream random);

/// The path of an object, part by part.
class ObjectPath {
 public:
  /// @param end_s time of the last frame, after which nothing is drawn
  ObjectPath(const SimulationObject& object, const Motions& frames, double end_s,
             std::uint64_t seed);

  /// T_world_object; where the object is nowhere, as it was.
  Pose at(Real time_s) const;
  /// Whether the object is there.
  bool is_present(Real time_s) const;

 private:
  struct Part {
    Real start_s;
    Motion motion;
    bool present;
  };
  const Part& part_at(Real time_s) const;
  void add(Real start_s, Motion motion, bool present = true);
  void add_still(Real start_s, const Pose& pose);

  void add(const SimulationConveyor& conveyor);
  void add(const SimulationHeld& held, const Motions& frames);
  void add(const SimulationPickAndPlace& carried, RandomStream random);
  void add(const SimulationPutDown& put, RandomStream random);
  /// Calls `move(time, place)`, which returns the time at which the object stands again.
  template <class Move>
  void repeat(const SimulationMoves& moves, RandomStream& random, Move&& move);

  Pose first_;
  Real appears_s_;
  Real removed_s_;
  Real end_s_;
  std::vector<Part> parts_;
};

}  // namespace posemix::internal::simulation
