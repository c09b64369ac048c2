// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "posemix/base/units.hpp"

/// How simulated objects move: the truth, T_world_object over time. The world's z axis points up.
/// Times are in seconds from the first frame. Paths do not depend on the times of the frames.
namespace posemix {

/// Standard deviations of a pose error about and along x, y, z.
struct SimulationSd {
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
};

/// A pose in the world.
struct SimulationPlace {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();  ///< rotation vector
};

/// The object goes straight on with a constant twist along the world's axes; it starts and stops at
/// once.
struct SimulationConveyor {
  double start_s = 0.0;
  double stop_s = std::numeric_limits<double>::infinity();
  Eigen::Vector3d velocity_m_s{0.1, 0.0, 0.0};
  Eigen::Vector3d turn_rad_s = Eigen::Vector3d::Zero();  ///< about the object's origin
};

/// A hand moves the object at random about the place where it takes it, and lets go of it wherever
/// it is. With the local time tau, which starts and stops smoothly, each of the six coordinates x
/// (position, and rotation vector from the first orientation, along its axes) is a damped
/// oscillator under white acceleration a, d^2x = -1.4 w dx - w^2 x + a dW, with w such that the
/// stationary deviation is a third of the reach; what is beyond two thirds of the reach is bent
/// back, so that all of it stays within.
struct SimulationHandHeld {
  double start_s = 0.0;
  double stop_s = std::numeric_limits<double>::infinity();
  Eigen::Vector3d reach_m{0.3, 0.3, 0.2};  ///< farthest from the start, world axes
  double reach_rad = radians(90.0);        ///< largest coordinate of the rotation vector
  /// White acceleration in calm parts [rad / s^(3/2), m / s^(3/2)].
  SimulationSd acceleration{Eigen::Vector3d::Constant(0.4), Eigen::Vector3d::Constant(0.4)};
  double agile_factor = 5.0;  ///< on the acceleration in agile parts
  double calm_s = 1.0;        ///< mean length of a calm part
  double agile_s = 1.0 / 3;   ///< mean length of an agile part; 0: there are none
  double ramp_s = 0.5;        ///< in which the motion starts, and stops
};

/// When and to which places an object is moved. Moves that begin before `stop_s` are completed.
struct SimulationMoves {
  double start_s = 0.0;
  double stop_s = std::numeric_limits<double>::infinity();
  std::vector<double> times_s = {};  ///< at which the object is moved
  /// In place of times: the rate at which an object that stands still is moved [1/s].
  double rate_per_s = 0.0;
  /// To these places in turn; empty: to any in a box about the place of the object at time zero,
  /// turned about the vertical by any angle.
  std::vector<SimulationPlace> places = {};
  Eigen::Vector3d area_m{0.2, 0.2, 0.0};  ///< half the edges of the box
};

/// The object is picked, carried and put down elsewhere: along a straight line plus a lift, with
/// the smooth (minimum-jerk) profile 10 u^3 - 15 u^4 + 6 u^5 of the way and the rotation.
struct SimulationPickAndPlace {
  SimulationMoves moves = {};
  double duration_s = 2.0;  ///< of one move
  double lift_m = 0.15;     ///< height above the line half-way
};

/// The object is put elsewhere unseen: it vanishes, and after a time is at another place.
struct SimulationPutDown {
  SimulationMoves moves = {};
  double hidden_s = 0.0;  ///< for which it is nowhere; 0: it jumps
};

/// A frame holds the object as it finds it: T_frame_object is that of the time at which it is taken
/// until it is let go of.
struct SimulationHeld {
  std::string frame = {};  ///< name of a SimulationFrame
  double start_s = 0.0;
  double stop_s = std::numeric_limits<double>::infinity();
};

/// A place on the path of a frame.
struct SimulationWaypoint {
  double time_s = 0.0;
  SimulationPlace place = {};
};

/// A frame that may hold objects, such as a gripper or a hand. It goes from one waypoint to the
/// next by the profile of SimulationPickAndPlace and stands at each; before the first and after the
/// last it is there.
struct SimulationFrame {
  std::string name = {};
  std::vector<SimulationWaypoint> waypoints = {};
  /// Error of the poses that a filter is told, drawn anew for every image: about and along the
  /// world's axes at the frame's origin.
  SimulationSd error{Eigen::Vector3d::Constant(radians(0.1)), Eigen::Vector3d::Constant(1e-3)};
};

}  // namespace posemix
