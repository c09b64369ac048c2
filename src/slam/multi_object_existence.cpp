// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/multi_object_slam.hpp"
#include "slam/searched_image.hpp"

/// Existence of the objects of MultiObjectSlam (docs/existence.md).
namespace posemix {

std::optional<double> MultiObjectSlam::existence(std::size_t object) const {
  objects_.require(object);
  return tracks_.existence(object);
}

bool MultiObjectSlam::is_confirmed(std::size_t object) const {
  objects_.require(object);
  return tracks_.is_confirmed(object);
}

void MultiObjectSlam::look(const FrameInput& input) {
  const auto look = [&](const std::string& camera, const std::optional<std::string>& detector) {
    // Detections without the name of a camera are seen from the body.
    const SE3d pose = camera.empty() ? SE3d() : pose_on_body(settings_.cameras, camera);
    tracks_.look(camera, detector, pose);
  };
  // Detections by index, an entry for every object, are an image even where it shows none.
  if (!input.detections.empty()) look({}, "");
  if (!input.candidates.empty()) look({}, "");
  for (const Observation& observation : input.observations)
    look(observation.camera, observation.detector);
  for (const std::string& name : input.images) {
    const internal::SearchedImage image = internal::searched_image(settings_.cameras, name);
    look(image.camera, image.detector);
  }
}

void MultiObjectSlam::update_tracks(FrameEstimate& frame) {
  std::vector<TrackedPlace> places;
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    const auto& relative = frame.relative[object];
    places.push_back(
        {relative ? std::optional(relative->mean()) : std::nullopt, place_probability(object)});
  }
  tracks_.end(places);
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    frame.existences.push_back(tracks_.existence(object));
    frame.healths.push_back(tracks_.health(object, frame.mode_probabilities[object].value_or(0.0)));
    frame.register_again.push_back(tracks_.should_register(object));
  }
}

void MultiObjectSlam::forget_deleted() {
  for (std::size_t object = 0; object < objects_.size(); ++object)
    if (tracks_.is_deleted(object)) forget(object);
  for (const std::size_t object : tracks_.duplicates()) {
    // One of three in a row may be gone with the first pair.
    if (is_known(object)) forget(object);
  }
}

}  // namespace posemix
