// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <string_view>

#include <fmt/format.h>

#include "filter/precision.hpp"
#include "posemix/base/error.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/detector/observation.hpp"

/// What callers of MultiObjectFilter give.
namespace posemix::internal {

inline void require_object(std::size_t object, std::size_t objects) {
  if (object >= objects)
    throw InvalidInput(fmt::format("there is no object {}; there are {}", object, objects));
}

inline void require_detector(std::size_t detector, std::size_t detectors) {
  if (detector >= detectors) {
    throw InvalidInput(
        fmt::format("the object has {} detectors; there is none at index {}", detectors, detector));
  }
}

inline void require_camera(std::size_t camera, std::size_t cameras) {
  if (camera >= cameras) {
    throw InvalidInput(
        fmt::format("there is no camera {} whose pose on the body is estimated; there are {}",
                    camera, cameras));
  }
}

inline void require_hypothesis(std::size_t hypothesis, std::size_t object, std::size_t hypotheses) {
  if (hypothesis >= hypotheses) {
    throw InvalidInput(fmt::format("object {} has {} hypotheses; there is none at index {}", object,
                                   hypotheses, hypothesis));
  }
}

/// Whether what is known of a pose before a detection and the noise of the detection can stand in
/// one covariance: that of the detector, and that of the observation where it states its own.
inline void require_comparable(const Matrix6d& predicted, const ObjectSensor& sensor,
                               const Observation& observation, std::string_view name) {
  for (const NoiseComponent& component : sensor.noise.components())
    require_precision(predicted, component.covariance, name);
  for (const ObservationComponent& component : observation.components)
    if (component.covariance) require_precision(predicted, *component.covariance, name);
}

}  // namespace posemix::internal
