// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <vector>

#include "placed_object.hpp"
#include "posemix/base/state_fields.hpp"

/// What a detector shows: the object, in one of its modes, or something else
/// (docs/moving-objects.md, "The detector").
namespace posemix::internal {

/// The right modes of a noise model: components with the same offset are one.
class DetectorModes {
 public:
  explicit DetectorModes(const DetectorNoise& noise);

  /// Number of right modes.
  std::size_t count() const { return first_.size(); }
  /// The mode of a component of the noise.
  std::size_t mode_of(std::size_t component) const { return mode_of_[component]; }
  /// Index of the first component of a mode, which is the narrowest in models that are learned.
  std::size_t first(std::size_t mode) const { return first_[mode]; }
  /// Probability of a mode given that the detector is right.
  double share(std::size_t mode) const { return weights_[mode] / total_; }
  /// Sum of the weights of the mode's components.
  double weight(std::size_t mode) const { return weights_[mode]; }
  /// Probability that a detector is in the same mode as `dt` seconds before, at its last detection.
  double persistence(double dt) const;

 private:
  template <class>
  friend struct StateFields;

  std::vector<std::size_t> mode_of_;
  std::vector<std::size_t> first_;
  std::vector<double> weights_;
  double total_ = 0.0;
  double mode_time_s_;
  double run_length_ = 1.0;
};

/// The probabilities of detections that show something else.
struct WrongShares {
  double alone;   ///< of one that stands alone
  double in_run;  ///< of a run, given that the mode is drawn anew
};

/// The part `isolated` of wrong detections, whose probability is `clutter`, stands alone.
WrongShares wrong_shares(double clutter, double isolated);

/// How likely one Gaussian makes an observation, given what the detector shows [nats].
struct ModeEvidence {
  /// Given that the detector is right; the weights are those of the components within all modes.
  Explanation explanation;
  std::vector<double> log_right;  ///< by mode
  double log_wrong = 0.0;         ///< shows something else, drawn anew
  /// Of every component of the observation, the density if it is at this place in any orientation.
  std::vector<double> log_here;
  /// Probability, given that it does, that it shows this place in another orientation.
  double turned = 0.0;
  Innovation position = {};  ///< the innovation of the position alone, of a turned detection
  /// Of every component of the observation, the least squared Mahalanobis distance over the first
  /// components of the modes.
  std::vector<double> squared_distances;
};

/// `turned` is the part of wrong detections that are at the object's place; the others are anywhere
/// in the volume of clutter.
ModeEvidence mode_evidence(const DetectionState& state, const WeighedObservation& observation,
                           const ObjectSensor& sensor, const DetectorModes& modes, double turned);

}  // namespace posemix::internal
