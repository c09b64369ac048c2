// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/mode_measurement.hpp"

#include <algorithm>
#include <cmath>

#include "detection_update.hpp"

namespace posemix {

ModeMeasurement measure_mode(const ModeState& state, const Observation& observation,
                             const ObjectSensor& sensor) {
  validate(observation);
  internal::DetectionState all{.camera = state.camera, .object = state.object, .slow = state.slow};
  all.covariance.bottomRightCorner<12, 12>() = state.covariance;
  const internal::Explanation seen_as =
      internal::explain(all, internal::weigh(observation, sensor, 1.0, {}), sensor);
  ModeMeasurement result;
  if (!std::isfinite(seen_as.log_evidence)) return result;
  double most = 0.0;
  for (const internal::Innovation& seen : seen_as.innovations) {
    if (seen.weight == 0.0) continue;
    const Eigen::LLT<Matrix6d> noise(seen.noise);
    const Matrix6d information = seen.weight * noise.solve(Matrix6d::Identity());
    result.information += information;
    result.pull.noalias() += information * seen.residual;
    if (seen.weight > most) result.slow_map = seen.slow_map;
    most = std::max(most, seen.weight);
  }
  symmetrize(result.information);
  result.inlier_probability = seen_as.inlier_probability();
  result.clutter_probability = seen_as.clutter_probability;
  const std::size_t count = seen_as.innovations.size() / seen_as.noise_components;
  for (std::size_t k = 1; k < count; ++k) {
    if (seen_as.probability_of(k) > seen_as.probability_of(result.best_component))
      result.best_component = k;
  }
  return result;
}

ModeMeasurement measure_mode(const ModeState& state, const SE3d& detected,
                             const ObjectSensor& sensor) {
  return measure_mode(state, observation_of(detected), sensor);
}

}  // namespace posemix
