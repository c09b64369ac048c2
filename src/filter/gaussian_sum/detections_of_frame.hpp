// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "posemix/filter/gaussian_sum_filter.hpp"

/// The detections of one frame before the Gaussian-sum filter takes them in: what is refused, and
/// how they fit its hypotheses.
namespace posemix::internal {

/// The squared Mahalanobis distance [six degrees of freedom] beyond which a detection is left out.
/// @throws InvalidInput for a probability that is not in (0, 1]
double gate_threshold(double probability);

/// @throws InvalidInput when a detection is of the camera, of a pose that there is not, of one that
/// is detected twice, or as check_pose
void check_detections(std::span<const Detection> detections, std::size_t poses);

/// A pose before a detection may be no more uncertain than rounding allows, in the world and near
/// the scene, where the update is computed.
/// @throws InvalidInput as require_precision
void check_precision(const Posterior& prior, std::size_t pose, const DetectorNoise& noise);

/// The number of noise components that all detectors share, with the same weights (eq. 33).
/// @throws InvalidInput when they do not
std::size_t common_components(std::span<const Detection> detections);

/// Detections with noise models that take successive errors for independent, as this filter does.
class WhiteDetections {
 public:
  explicit WhiteDetections(std::span<const Detection> given)
      : detections_(given.begin(), given.end()) {
    noise_.reserve(given.size());
    for (Detection& detection : detections_) {
      if (!detection.noise->is_white())
        detection.noise = &noise_.emplace_back(detection.noise->as_white());
    }
  }
  std::span<const Detection> detections() const { return detections_; }

 private:
  std::vector<Detection> detections_;
  std::vector<DetectorNoise> noise_;
};

/// z^T S^-1 z of the heaviest hypothesis under the noise component that explains a detection best.
std::optional<double> nis_of(const Posterior& posterior, const Detection& detection);

/// True when the detection is beyond the threshold for every hypothesis and noise component.
bool is_outlier(const Posterior& posterior, const Detection& detection, double threshold);

}  // namespace posemix::internal
