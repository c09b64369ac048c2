// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "messages.hpp"
#include "posemix/detector/observation.hpp"
#include "settings.hpp"

/// Messages of detectors as observations. The rules are those of bags (docs/interop.md).
namespace posemix::internal {

/// One sighting of an image: the results of the class of the best one.
struct LiveDetection {
  std::string class_id;
  double score;
  std::string frame;  ///< in which its poses are
  std::vector<ObservationComponent> components;
};

/// What a detector says of one image.
struct LiveImage {
  std::int64_t stamp_ns = 0;
  std::string frame = {};     ///< of the camera, by the header of the message
  std::string detector = {};  ///< of Observation::detector
  double arrival_s = 0.0;     ///< by a clock that does not jump
  std::vector<LiveDetection> detections = {};
};

/// The images of a message, one per stamp; an array without detections is one that shows nothing.
/// `now_ns` is the stamp of a message that has none.
/// @throws InvalidInput for a pose or a covariance that is none; it names the source, the stamp and
/// the detection
std::vector<LiveImage> images_of(const RosDetections& message, const LiveSource& source,
                                 double arrival_s, std::int64_t now_ns);

/// Weights of poses that exclude each other, from a detector's scores of them: their shares. Where
/// one of them is negative or not finite, or all are zero, all weights are equal.
std::vector<double> weights_of_scores(const std::vector<double>& scores);

}  // namespace posemix::internal
