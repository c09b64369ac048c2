// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "filter/moving_object_scene.hpp"
#include "posemix/slam/relocalise.hpp"

/// Two maps of one table, whose worlds are at different places.
namespace posemix::testing::relocalise {

inline const SE3d kFlip = pose(0.0, 0.0, std::numbers::pi, 0.0, 0.0, 0.0);
inline const SE3d kNewOld = pose(0.3, -0.5, 1.2, 0.7, -0.4, 0.2);

using Places = std::map<std::string, SE3d>;

inline const Places kTable{{"mug", pose(0.3, 0.2, 0.5, -0.2, 0.1, 0.9)},
                           {"box", pose(0.1, 1.0, 0.2, 0.25, 0.05, 1.0)},
                           {"can", pose(0.0, 0.3, -0.4, 0.0, 0.3, 1.1)},
                           {"tin", pose(0.2, -0.3, 1.0, -0.3, -0.2, 1.2)},
                           {"jar", pose(1.2, 0.5, 0.0, 0.3, -0.25, 0.8)}};

/// The can looks the same from all sides, and the tin after half a turn.
inline std::vector<ObjectModel> models() {
  std::vector<ObjectModel> all;
  for (const auto& [id, place] : kTable)
    all.push_back({.id = id, .noise = gaussian_noise(2.0, 0.01)});
  for (ObjectModel& model : all) {
    if (model.id == "can") model.symmetries = SymmetryGroup::turns({0.0, 0.0, 1.0}, 0);
    if (model.id == "tin") model.symmetries = SymmetryGroup::turns({1.0, 0.0, 0.0}, 2);
  }
  return all;
}

/// A run in a world in which the table is at `world`: a still camera of which `seconds` are seen.
/// Detections of the mug and the tin are flipped or their symmetric images now and then.
inline MultiObjectSlam run(std::uint64_t seed, const SE3d& world, const Places& places,
                           const std::vector<std::string>& seen,
                           const std::vector<ObjectModel>& all = models(), double flips = 0.3) {
  RandomStream stream(seed, 5);
  const Matrix6d start = isotropic(1.0, 0.02);
  const SE3d camera = world;
  MultiObjectSlamSettings settings;
  settings.filter.noise_scale_detections = std::numeric_limits<double>::infinity();
  MultiObjectSlam slam(PoseDensity(SE3d::exp(draw(start, stream)) * camera, start), all, settings,
                       {.model = MotionModel::still});
  for (int k = 0; k < 12; ++k) {
    FrameInput input{.dt = 1.0};
    for (const std::string& id : seen) {
      SE3d at =
          camera.inverse() * world * places.at(id) * SE3d::exp(draw(isotropic(2.0, 0.01), stream));
      if (id == "mug" && stream.uniform() < flips) at = at * kFlip;
      if (id == "tin" && stream.uniform() < 0.5) at = at * pose(std::numbers::pi, 0, 0, 0, 0, 0);
      if (id == "can") at = at * pose(0.0, 0.0, 6.0 * stream.uniform(), 0.0, 0.0, 0.0);
      Observation observation = observation_of(at);
      observation.object = id;
      input.observations.push_back(observation);
    }
    slam.step(input);
  }
  return slam;
}

inline MultiObjectSlam old_map(std::uint64_t seed) {
  return run(seed, SE3d(), kTable, {"mug", "box", "can", "tin", "jar"});
}

}  // namespace posemix::testing::relocalise
