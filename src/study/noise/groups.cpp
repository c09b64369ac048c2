// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/groups.hpp"

#include <algorithm>
#include <cctype>
#include <map>

namespace posemix {

std::vector<NoiseGroup> noise_groups(const std::vector<ResidualSet>& sets) {
  std::vector<std::string> detectors;
  for (const ResidualSet& set : sets) {
    if (std::find(detectors.begin(), detectors.end(), set.detector) == detectors.end())
      detectors.push_back(set.detector);
  }
  std::vector<NoiseGroup> groups;
  for (const std::string& detector : detectors) {
    const std::size_t first = groups.size();
    NoiseGroup all{detector, "all", false, {}};
    for (const ResidualSet& set : sets) {
      if (set.detector != detector) continue;
      auto group = std::find_if(groups.begin() + static_cast<std::ptrdiff_t>(first), groups.end(),
                                [&](const NoiseGroup& g) { return g.object == set.object; });
      if (group == groups.end()) group = groups.insert(group, {detector, set.object, true, {}});
      group->sets.push_back(set);
      if (!set.symmetric) all.sets.push_back(set);
    }
    if (groups.size() > first + 1 && !all.sets.empty()) groups.push_back(std::move(all));
  }
  return groups;
}

std::string noise_name(const std::string& detector, const std::string& object) {
  std::string name = detector + "_" + object;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-') c = '_';
  }
  return name;
}

std::vector<NoiseTrack> tracks_of(const NoiseGroup& group) {
  std::vector<NoiseTrack> tracks;
  std::map<std::string, std::size_t> recordings;
  for (const ResidualSet& set : group.sets) {
    const std::size_t recording =
        recordings.emplace(set.recording, recordings.size()).first->second;
    tracks.push_back(noise_track(set.truth, set.detected, recording, set.stamps_s));
  }
  return tracks;
}

}  // namespace posemix
