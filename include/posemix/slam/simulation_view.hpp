// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/base/words.hpp"
#include "posemix/slam/simulation_motion.hpp"

/// What the camera of a simulation sees, and what it sees wrongly.
namespace posemix {

/// How the camera moves, and how its pose is known.
enum class SimulationSetUp {
  moving,  ///< it goes along its path, and odometry tells its motion
  still,   ///< it stays at the first pose of its path; its pose has one error for good
  on_arm   ///< it goes along its path, and an arm tells its pose with an error that is drawn anew
           ///< for every image
};

/// The words of SimulationSetUp in files.
template <>
inline constexpr WordTable<SimulationSetUp, 3> words<SimulationSetUp>{{
    {"moving", SimulationSetUp::moving},
    {"still", SimulationSetUp::still},
    {"on_arm", SimulationSetUp::on_arm},
}};

/// A pinhole camera with the principal point in the middle. An object is seen while its origin is
/// in the image and the range.
struct SimulationView {
  std::int64_t width_px = 640;
  std::int64_t height_px = 480;
  double focal_length_px = 600.0;
  double least_range_m = 0.2;    ///< along the optical axis
  double largest_range_m = 2.0;  ///< along the optical axis
};

/// A disturbance that comes in runs of frames: a two-state Markov chain.
struct SimulationRuns {
  double fraction = 0.0;    ///< of the frames that are disturbed, in [0, 1]
  double mean_run_s = 0.0;  ///< runs are at least as long as independent frames make them
};

/// False detections of a class or of an object.
struct SimulationClutter {
  std::string class_id = {};  ///< that the detections name; empty: `object`
  std::string object = {};    ///< id of an object that the detections name; empty: `class_id`
  /// Mean number per image of those that are anywhere: uniform over the volume that is in view and
  /// over all rotations, and independent of each other (a Poisson process).
  double rate_per_image = 0.0;
  /// Places in the world at which something looks like the object, while they are in view: in runs.
  std::vector<SimulationPlace> places = {};
  SimulationRuns runs = {};  ///< of each place
  /// Error of a detection at a place, Y = T_camera_place Exp(n).
  SimulationSd sd{Eigen::Vector3d::Constant(radians(4.0)), Eigen::Vector3d::Constant(5e-3)};
};

}  // namespace posemix
