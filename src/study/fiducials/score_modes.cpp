// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <set>

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

CameraPoses camera_poses(std::span<const RigCamera> cameras) {
  CameraPoses poses;
  for (const RigCamera& camera : cameras) {
    if (camera.rig_camera) poses.emplace(camera.name, camera.rig_camera->pose);
  }
  return poses;
}

std::vector<TagSighting> estimated_sightings(const Sequence& sequence, const SlamRun& run,
                                             const CameraPoses& cameras) {
  std::map<std::string, std::size_t> objects;
  for (std::size_t i = 0; i < sequence.objects.size(); ++i) objects[sequence.objects[i].id] = i;
  std::vector<TagSighting> sightings;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    for (const Observation& observation : sequence.observations[k]) {
      const auto object = objects.find(observation.object);
      const auto mounting = cameras.find(observation.camera);
      if (object == objects.end() || mounting == cameras.end()) continue;
      const auto& relative = run.frames[k].relative[object->second];
      if (!relative) continue;
      sightings.push_back({observation.stamp_s, observation.camera, observation.object,
                           mounting->second.inverse() * relative->mean()});
    }
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
    const bool wrong = is_wrong_mode(sighting.pose, expected);
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
