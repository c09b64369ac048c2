// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/limits.hpp"
#include "posemix/slam/simulation.hpp"

/// Checks of a recording that a simulation made, or somebody else.
namespace posemix {
namespace {

void refuse(std::string_view of, std::string_view what) {
  throw InvalidInput(fmt::format("simulated recording: {} {}", of, what));
}

void check_entries(std::string_view of, std::size_t entries, std::size_t stamps) {
  if (entries != stamps) refuse(of, fmt::format("has {} entries for {} stamps", entries, stamps));
}

void check_pose(std::string_view of, const SimulatedPose& pose) {
  const auto& n = pose.billionths;
  const auto is_far = [](std::int64_t number) {
    return std::abs(static_cast<double>(number)) > 1e9 * kFarthestPosition;
  };
  if (std::any_of(n.begin(), n.end(), is_far))
    refuse(of, fmt::format("has a pose with a coordinate beyond {:g}", kFarthestPosition));
  if (std::all_of(n.begin() + 3, n.end(), [](std::int64_t number) { return number == 0; }))
    refuse(of, "has a pose whose quaternion is zero");
}

void check_track(std::string_view of, const std::vector<SimulatedPose>& track, std::size_t stamps) {
  check_entries(of, track.size(), stamps);
  for (const SimulatedPose& pose : track) check_pose(of, pose);
}

void check_object(const SimulatedObject& object, bool has_sightings, std::size_t stamps) {
  const auto name = [&](std::string_view part) {
    return fmt::format("{} of object '{}'", part, object.id);
  };
  check_track(name("relative_truth"), object.relative_truth, stamps);
  check_entries(name("detections"), object.detections.size(), stamps);
  for (const auto& detection : object.detections)
    if (detection) check_pose(name("detections"), *detection);
  if (object.world_path.empty()) check_pose(name("world_truth"), object.world_truth);
  if (!object.world_path.empty()) check_track(name("world_path"), object.world_path, stamps);
  if (!object.present.empty()) check_entries(name("present"), object.present.size(), stamps);
  if (!has_sightings && !object.class_id.empty())
    refuse(fmt::format("object '{}'", object.id), "has a class, but there are no sightings");
}

void check_sightings(const SimulatedSequence& simulated) {
  check_entries("sightings", simulated.sightings.size(), simulated.stamps_ns.size());
  for (const auto& frame : simulated.sightings) {
    for (const SimulatedSighting& sighting : frame) {
      check_pose("sightings", sighting.pose);
      if (sighting.source && *sighting.source >= simulated.objects.size())
        refuse("sightings", fmt::format("have object {} as their source; there are {}",
                                        *sighting.source, simulated.objects.size()));
    }
  }
}

}  // namespace

void validate(const SimulatedSequence& simulated) {
  const std::size_t stamps = simulated.stamps_ns.size();
  check_track("odometry", simulated.odometry, stamps);
  check_track("camera_truth", simulated.camera_truth, stamps);
  for (const SimulatedObject& object : simulated.objects)
    check_object(object, !simulated.sightings.empty(), stamps);
  for (const SimulatedFrame& frame : simulated.frames) {
    check_track(fmt::format("truth of frame '{}'", frame.name), frame.truth, stamps);
    check_track(fmt::format("given of frame '{}'", frame.name), frame.given, stamps);
  }
  if (!simulated.sightings.empty()) check_sightings(simulated);
}

}  // namespace posemix
