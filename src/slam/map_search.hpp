// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "map_pairs.hpp"
#include "posemix/slam/relocalise.hpp"

namespace posemix::internal {

/// A pose of the old map with the objects that agree on it.
struct MapPose {
  PairsFit fit;
  double log_probability;  ///< eq. (7) of docs/state.md, up to a constant
};

/// Whether objects of two maps may be one: by their ids, or by their class.
bool may_be_one(const ObjectModel& a, const ObjectModel& b);

/// The search for the poses of an old map.
class MapSearch {
 public:
  MapSearch(const MapSide& old_map, const MapSide& now, const RelocaliseSettings& settings);

  /// Objects of the new run that the old map may have.
  const std::vector<std::size_t>& shared() const { return shared_; }
  /// All poses that differ, the most probable first.
  std::vector<MapPose> poses() const;

 private:
  /// Pairs of an object of the new run.
  std::vector<MapPair> candidates_of(std::size_t object) const;
  /// Poses T_new_old by one pair, one for each of its symmetric images.
  std::vector<SE3d> starts_of(const MapPair& pair) const;
  double log_prior(const MapPair& pair) const;
  MapPose grown(const MapPair& first, const SE3d& start) const;
  /// The most probable pair that agrees with those that are fitted and is none of the `rejected`.
  std::optional<MapPair> next_pair(const PairsFit& fit, const std::vector<MapPair>& rejected) const;
  double log_probability(const PairsFit& fit) const;
  /// Whether a pose that was found has this pair, and is where the pair alone has it.
  bool leads_to_known(const MapPair& pair, const SE3d& start,
                      const std::vector<MapPose>& known) const;
  bool are_same(const PairsFit& a, const PairsFit& b) const;

  const MapSide& old_;
  const MapSide& now_;
  double gate_;
  double log_moved_;
  double log_stayed_;
  std::vector<std::size_t> shared_;
};

}  // namespace posemix::internal
