// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "detection_update.hpp"
#include "filter/moving/detector_modes.hpp"
#include "filter/moving/mode_weights.hpp"
#include "posemix/filter/object_motion.hpp"

/// Objects that are put down elsewhere (docs/many-objects.md).
namespace posemix::internal {

/// How an object is put down, and what its detectors may show.
struct PutDown {
  PutDownMotion motion;
  std::vector<DetectorModes> detectors;

  /// What the detectors show of an object that none has seen: they are right.
  std::vector<ModeWeights> unseen() const;
};

/// The place of the hypothesis with an id, for runs of wrong detections.
inline std::uint64_t place_of(std::uint64_t id) { return id + 1; }

/// The modes of the detector that makes an observation.
struct ShownModes {
  const DetectorModes& modes;
  std::size_t detector;  ///< its index
  double stay;           ///< probability that its mode is that of its last observation
  double clutter;        ///< probability that the observation is of something else
};

/// What an observation says of an object that is put down elsewhere: eq. (22).
struct PutDownEvidence {
  std::size_t detector = 0;
  double alone = 0.0;  ///< probability of a wrong detection that stands alone
  std::vector<ModeWeights> shown =
      {};                          ///< by hypothesis: modes after the observation; they sum to one
  std::vector<double> begun = {};  ///< by hypothesis, the part of these that is a run that begins
  std::vector<double> score = {};  ///< by hypothesis, the log evidence of independent detections
  double log_lost = 0.0;           ///< log evidence of the case that the place is not known [nats]
  ModeWeights lost = {};           ///< the same for that case
  double lost_begun = 0.0;
  Eigen::ArrayXd lost_right = {};  ///< by mode, for births: the modes before the observation
  /// By component of the observation, the hypothesis that explains it best.
  std::vector<std::optional<std::size_t>> explaining = {};
};

/// Adds weights to others, each times a factor.
void mix_into(std::vector<ModeWeights>& shown, double factor, const std::vector<ModeWeights>& other,
              double other_factor);

}  // namespace posemix::internal
