// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include "posemix/detector/noise_observation.hpp"
#include "study/noise/study.hpp"

/// The recordings of one work item of `study noise`.
namespace posemix {

/// The recordings that are studied together.
struct NoiseGroup {
  std::string detector;
  std::string object;
  bool one_class = true;  ///< all sets are of one class of objects
  std::vector<ResidualSet> sets = {};
};

/// One group by detector and object, in the order of appearance, and `all` of a detector, without
/// symmetric objects, after its objects where it has several.
std::vector<NoiseGroup> noise_groups(const std::vector<ResidualSet>& sets);

/// The frames with a truth of every set. Sets of one name of recording have the same number.
std::vector<NoiseTrack> tracks_of(const NoiseGroup& group);

/// The name of files and of the noise model: detector and object, with letters, digits, '_' and
/// '-'.
std::string noise_name(const std::string& detector, const std::string& object);

}  // namespace posemix
