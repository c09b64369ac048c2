// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "slam/smoothing_moving.hpp"

namespace posemix::internal {
namespace {

/// The place of an object at every frame, counted from zero: another hypothesis that leads is
/// another place.
std::vector<std::optional<std::size_t>> places_of(const SmoothedTrack& track) {
  std::vector<std::optional<std::size_t>> places;
  std::optional<std::uint64_t> at;
  std::optional<std::size_t> place;
  for (const auto& estimate : track) {
    if (estimate && !estimate->hypotheses.empty()) {
      const std::uint64_t now = estimate->hypotheses.front().id;
      if (at != now) place = place ? *place + 1 : 0;
      at = now;
    }
    places.push_back(place);
  }
  return places;
}

/// The id of an object at one of its places, which no other object has.
std::string id_at(const std::string& id, std::size_t place,
                  const std::vector<ObjectModel>& models) {
  std::string own = fmt::format("{} (place {})", id, place + 1);
  while (std::ranges::any_of(models, [&](const auto& model) { return model.id == own; }))
    own += '\'';
  return own;
}

/// The detections of the frames in which an object is at one of its places.
ObjectRecording recording_at(const ObjectRecording& object,
                             const std::vector<std::optional<std::size_t>>& places,
                             std::size_t place, std::string id) {
  ObjectRecording part{.id = std::move(id),
                       .detections = std::vector<std::optional<SE3d>>(places.size()),
                       .relative_truth = {},
                       .world_truth = {}};
  for (std::size_t k = 0; k < part.detections.size(); ++k)
    if (places[k] == place) part.detections[k] = object.detections[k];
  return part;
}

/// Observations of the static objects, under their ids; those of objects that move are left out.
std::vector<std::vector<Observation>> observations_of(const Sequence& sequence,
                                                      const StaticPart& part) {
  std::map<std::string, std::size_t, std::less<>> indices;
  for (std::size_t j = 0; j < sequence.objects.size(); ++j)
    indices.emplace(sequence.objects[j].id, j);
  std::vector<std::vector<Observation>> all(sequence.observations.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    for (const Observation& observation : sequence.observations[k]) {
      const auto object = indices.find(observation.object);
      if (object == indices.end()) continue;
      const auto at = part.object_at[object->second][k];
      if (!at) continue;
      all[k].push_back(observation);
      all[k].back().object = part.models[*at].id;
    }
  }
  return all;
}

}  // namespace

StaticPart static_part(const Sequence& sequence, const std::vector<ObjectModel>& models,
                       const std::vector<SmoothedTrack>& tracks) {
  const std::size_t frames = sequence.stamps.size();
  StaticPart part{.sequence = {.stamps = sequence.stamps,
                               .odometry = sequence.odometry,
                               .camera_truth = {},
                               .objects = {}}};
  const auto add = [&](const ObjectModel& model, ObjectRecording recording, bool is_first) {
    part.models.push_back(model);
    part.models.back().id = recording.id;
    part.models.back().motion = {};
    if (!is_first) part.models.back().prior.reset();
    part.sequence.objects.push_back(std::move(recording));
  };
  for (std::size_t j = 0; j < models.size(); ++j) {
    auto& object_at = part.object_at.emplace_back(frames);
    if (has_own_track(models[j].motion)) continue;
    std::vector<std::optional<std::size_t>> places(frames, 0);
    const bool is_put_down = put_down_of(models[j].motion).has_value();
    if (is_put_down) places = places_of(tracks[j]);
    const std::size_t count = places.back() ? *places.back() + 1 : 0;
    for (std::size_t k = 0; k < frames; ++k)
      if (places[k]) object_at[k] = part.models.size() + *places[k];
    for (std::size_t place = 0; place < count; ++place) {
      std::string id = is_put_down ? id_at(models[j].id, place, models) : models[j].id;
      add(models[j], recording_at(sequence.objects[j], places, place, std::move(id)), place == 0);
    }
  }
  part.sequence.observations = observations_of(sequence, part);
  return part;
}

}  // namespace posemix::internal
