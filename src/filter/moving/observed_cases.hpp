// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "detector_modes.hpp"
#include "placed_object.hpp"

/// What an observation makes of one Gaussian, by what it shows: docs/moving-objects.md, "The
/// detector".
namespace posemix::internal {

/// One case, and what the Gaussian is in it.
struct ObservedCase {
  /// Of the innovation, by component of the observation and of the noise; none where the detector
  /// is wrong.
  std::optional<std::size_t> innovation;
  double weight;  ///< probability given the Gaussian
  PlacedObject object;
};

/// What the update of a Gaussian needs of the observation and the model.
struct CaseInput {
  const WeighedObservation& observation;
  const KnownFrame& camera;
  const ObjectSensor& sensor;
  const Vector18d& gain;
};

/// All cases that have more than a negligible probability, the most probable first. The weights of
/// the innovations in `evidence` are probabilities. Every component of the noise in every mode is
/// a case, and so is a wrong detection, which tells the position alone or nothing.
std::vector<ObservedCase> observed_cases(const PlacedObject& object, const ModeEvidence& evidence,
                                         const CaseInput& input);

/// The innovations of cases that fit one Gaussian, and whether a wrong detection is among them.
struct CaseGroup {
  std::vector<std::size_t> innovations = {};
  bool has_wrong = false;

  bool has(std::size_t innovation) const;
  bool has(const ObservedCase& one) const;
};

/// The cases in groups that fit one Gaussian, that of the most probable case first.
std::vector<CaseGroup> groups_of(const std::vector<ObservedCase>& cases);

/// Whether one Gaussian says what two of these weights say: no variance of the pose, in the place
/// of the object, becomes more than half as large again as that of either of them. Next to a place
/// that is known sharply, such as that of a run of wrong detections, what is wider loses with every
/// detection.
bool fit_one_gaussian(const WeightedObject& a, const WeightedObject& b);

}  // namespace posemix::internal
