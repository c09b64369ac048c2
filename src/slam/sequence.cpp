// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/sequence.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

void check_length(std::size_t length, std::size_t frames, const std::string& what) {
  if (length != 0 && length != frames) {
    throw InvalidInput(fmt::format("{} has {} entries for {} frames", what, length, frames));
  }
}

}  // namespace

void validate(const Sequence& sequence) {
  const std::size_t frames = sequence.stamps.size();
  require(frames > 0, "a sequence needs at least one frame");
  for (std::size_t k = 0; k < frames; ++k) {
    const double stamp = sequence.stamps[k];
    if (!std::isfinite(stamp) || (k > 0 && !(stamp > sequence.stamps[k - 1]))) {
      throw InvalidInput(fmt::format(
          "stamp {} of frame {} is not finite and larger than the one before", stamp, k));
    }
  }
  check_length(sequence.odometry.size(), frames, "odometry");
  check_length(sequence.camera_truth.size(), frames, "camera truth");
  check_length(sequence.candidates.size(), frames, "candidates");
  check_length(sequence.observations.size(), frames, "observations");
  check_length(sequence.images.size(), frames, "images");
  std::set<std::string> names;
  for (const FrameRecording& frame : sequence.known_frames) {
    if (!names.insert(frame.name).second)
      throw InvalidInput(fmt::format("the name '{}' of a known frame occurs twice", frame.name));
    if (frame.poses.size() != frames) {
      throw InvalidInput(fmt::format("the known frame '{}' has {} entries for {} frames",
                                     frame.name, frame.poses.size(), frames));
    }
  }
  std::set<std::string> ids;
  for (const ObjectRecording& object : sequence.objects) {
    if (!ids.insert(object.id).second) {
      throw InvalidInput(fmt::format("object id '{}' occurs twice", object.id));
    }
    if (object.detections.size() != frames) {
      throw InvalidInput(fmt::format("object '{}' has {} detection entries for {} frames",
                                     object.id, object.detections.size(), frames));
    }
    check_length(object.relative_truth.size(), frames,
                 fmt::format("relative truth of object '{}'", object.id));
    check_length(object.world_truth.size(), frames,
                 fmt::format("world truth of object '{}'", object.id));
  }
}

}  // namespace posemix
