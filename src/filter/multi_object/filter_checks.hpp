// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <string_view>

#include <fmt/format.h>

#include "filter/precision.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/detector/object_sensor.hpp"

/// What callers of MultiObjectFilter give.
namespace posemix::internal {

inline void require_object(std::size_t object, std::size_t objects) {
  check_index(object, objects, "object");
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

/// Whether a prior and the noise of the object's detectors can stand in one covariance.
inline void require_precision(const Matrix6d& prior, const ObjectSensor& sensor,
                              std::string_view name) {
  const auto check = [&](const DetectorNoise& noise) {
    for (const NoiseComponent& component : noise.components())
      require_precision(prior, component.covariance, name);
  };
  check(sensor.noise);
  for (const DetectorNoise& other : sensor.other_detectors) check(other);
}

/// The same of what a detector's noise itself holds: its slow error, and components. Factors on it
/// must be numbers.
inline void require_noise_precision(const ObjectSensor& sensor) {
  constexpr NumberRange kScale{.lowest = 0, .highest = 1e6};
  for (Eigen::Index i = 0; i < 6; ++i) {
    kScale.check(sensor.noise_scale[i], "a factor on the noise of a detector (noise_scale)");
    kScale.check(sensor.slow_scale[i], "a factor on the slow error of a detector (slow_scale)");
  }
  const auto check = [](const DetectorNoise& noise) {
    const auto& slow = noise.dependence().slow;
    for (const NoiseComponent& fine : noise.components()) {
      if (slow)
        require_precision(slow->covariance, fine.covariance, "the slow error of a detector");
      for (const NoiseComponent& wide : noise.components())
        require_precision(wide.covariance, fine.covariance, "a component of a detector's noise");
    }
  };
  check(sensor.noise);
  for (const DetectorNoise& other : sensor.other_detectors) check(other);
}

}  // namespace posemix::internal
