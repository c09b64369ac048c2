// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "put_down.hpp"

#include <cmath>
#include <numbers>

#include "multi_object_state.hpp"

namespace posemix::internal {

/// Eq. (22) and (23). Returns the hypotheses that begin.
Alternatives MultiObjectState::take_in_put_down(TrackedObject& object,
                                                const ObservedDetection& observed,
                                                const Starters& may_start) {
  constexpr double kPi = std::numbers::pi;
  const PutDownEvidence& seen = *observed.put_down;
  const WeighedObservation& observation = observed.observation;
  ObjectBelief& belief = object.belief;
  // The density of an object that was put down anywhere, times the modes of the detector.
  const double log_density = belief.log_absent() + std::log1p(-seen.alone) -
                             std::log(8.0 * kPi * kPi * object.put_down->motion.volume_m3);
  BirthPlaces jumps{.detector = seen.detector, .places = {}};
  for (const double part : seen.lost_right) jumps.log_modes.push_back(log_density + std::log(part));
  for (const auto& h : seen.explaining)
    jumps.places.push_back(h ? place_of(belief.standing(*h).id) : kAnyPlace);
  Alternatives births = births_of(object, observation, may_start, 1.0, &jumps);
  belief.take_in(seen, observed.updates, jumps.places, observation.components,
                 observation.log_absence, settings.score_memory);
  for (std::size_t i = 0; i < seen.explaining.size(); ++i) {
    if (!seen.explaining[i]) continue;
    for (std::size_t m = 0; m < jumps.log_modes.size(); ++m) {
      const double log_weight = jumps.log_modes[m] + std::log(observation.components[i].weight);
      if (std::isfinite(log_weight))
        belief.add_jump(*seen.explaining[i], log_weight, seen.detector, m);
    }
  }
  return births;
}

}  // namespace posemix::internal
