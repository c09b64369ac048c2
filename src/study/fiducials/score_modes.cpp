// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include "score.hpp"

namespace posemix {

std::vector<TagSighting> best_sightings(std::span<const Observation> observations) {
  std::vector<TagSighting> sightings;
  sightings.reserve(observations.size());
  for (const Observation& observation : observations) {
    sightings.push_back({observation.stamp_s, observation.camera, observation.object,
                         observation.components[best_component(observation)].pose});
  }
  return sightings;
}

ModeScore score_modes(std::span<const TagSighting> sightings, const CameraPoses& cameras,
                      const ReferenceTags& tags, const ReferencePath& reference) {
  ModeScore score;
  std::set<double> frames, wrong_frames;
  for (const TagSighting& sighting : sightings) {
    const auto mounting = cameras.find(sighting.camera);
    const auto known = tags.find(sighting.tag);
    if (mounting == cameras.end() || known == tags.end()) continue;
    const std::optional<SE3d> rig = reference.at(sighting.stamp_s);
    if (!rig) continue;
    const SE3d expected = (*rig * mounting->second).inverse() * known->second.pose;
    const bool wrong = angle_between_deg(sighting.pose, expected) > kWrongModeDeg;
    ModeScore::Tag& tag = score.tags[sighting.tag];
    if (tag.sightings == 0 || sighting.stamp_s >= tag.last_s) {
      tag.last_s = sighting.stamp_s;
      tag.wrong_at_last = wrong;
    }
    ++tag.sightings;
    ++score.sightings;
    frames.insert(sighting.stamp_s);
    if (!wrong) continue;
    ++tag.wrong;
    ++score.wrong;
    wrong_frames.insert(sighting.stamp_s);
  }
  score.frames = frames.size();
  score.wrong_frames = wrong_frames.size();
  return score;
}

}  // namespace posemix
