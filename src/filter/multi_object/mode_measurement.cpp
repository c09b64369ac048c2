// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/mode_measurement.hpp"

#include <cmath>

#include "pair.hpp"

namespace posemix {

ModeMeasurement measure_mode(const SE3d& camera, const SE3d& object, const Matrix6d& difference,
                             const SE3d& detected, const ObjectSensor& sensor,
                             GainCovariance gain_covariance) {
  internal::Pair pair{camera, object, internal::Matrix12d::Zero()};
  pair.covariance.bottomRightCorner<6, 6>() = difference;
  const internal::Explanation seen_as = internal::explain(pair, detected, sensor);
  ModeMeasurement result;
  if (!std::isfinite(seen_as.log_evidence)) return result;
  for (std::size_t i = 0; i < seen_as.innovations.size(); ++i) {
    if (seen_as.probabilities[i] == 0.0) continue;
    const internal::PairInnovation& seen = seen_as.innovations[i];
    const Eigen::LLT<Matrix6d> noise(internal::noise_in_gain(seen, gain_covariance));
    const Matrix6d information = seen_as.probabilities[i] * noise.solve(Matrix6d::Identity());
    result.information += information;
    result.pull.noalias() += information * seen.residual;
  }
  symmetrize(result.information);
  result.inlier_probability = seen_as.probabilities.front();
  result.clutter_probability = seen_as.probabilities.back();
  return result;
}

}  // namespace posemix
