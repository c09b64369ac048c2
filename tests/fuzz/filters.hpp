// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <utility>

#include "base/state_writer.hpp"
#include "input.hpp"
#include "invariants.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/observation.hpp"
#include "slam/stamped_state_fields.hpp"

/// What the targets of the filters have in common.
namespace posemix::fuzzing {

/// More steps take more time and show nothing that these do not.
inline constexpr int kMostSteps = 16;

/// All bits of a filter, as in a saved state.
template <class Filter>
std::string bits_of(const Filter& filter) {
  internal::StateWriter writer;
  writer(filter);
  return std::move(writer).take();
}

/// Does something that may be refused with InvalidInput, after which `bits()` of the filter are
/// those before. Returns whether it was done.
template <class Bits, class Action>
bool does(const Bits& bits, const Action& action) {
  const std::string before = bits();
  try {
    action();
  } catch (const InvalidInput& refusal) {
    expect(!std::string_view(refusal.what()).empty(), "a refusal without a reason");
    expect(bits() == before, "a refusal that changed the filter: " + std::string(refusal.what()));
    return false;
  }
  return true;
}

/// Of one to three components, in any frame, with or without clutter, a slow error and one in
/// common.
inline DetectorNoise noise_from(Input& input) {
  std::vector<NoiseComponent> components(1 + input.below(3));
  for (NoiseComponent& component : components) {
    component.weight = input.scale(1.0);
    component.covariance = input.covariance(0.05, 0.01);
    component.frame = static_cast<NoiseFrame>(input.below(3));
    if (input.flag()) component.offset = input.pose(0.1);
    if (input.flag()) component.run_length = 1.0 + static_cast<double>(input.below(8));
  }
  const Clutter clutter{input.flag() ? input.scale(0.05) : 0.0, input.scale(1.0)};
  NoiseDependence dependence;
  if (input.flag())
    dependence.slow = SlowError{input.covariance(0.03, 0.01), input.scale(1.0), input.scale(1.0)};
  if (input.flag()) dependence.common = input.covariance(0.01, 0.003);
  if (input.flag()) dependence.mode_time_s = input.scale(0.5);
  dependence.is_typical = input.flag();
  return DetectorNoise(components, clutter, dependence);
}

inline Observation observation_from(Input& input) {
  Observation observation;
  observation.components.resize(1 + input.below(3));
  const auto count = static_cast<double>(observation.components.size());
  for (ObservationComponent& component : observation.components) {
    component.weight = input.byte() < 240 ? 1.0 / count : input.number();
    component.pose = input.pose();
    if (input.flag()) component.covariance = input.covariance(0.05, 0.01);
  }
  if (input.flag()) observation.clutter = std::abs(input.number());
  return observation;
}

}  // namespace posemix::fuzzing
