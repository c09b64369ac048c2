// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "moving_object_state.hpp"
#include "posemix/base/limits.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix::internal {
namespace {

/// Whether a prediction says anything of where the object is: variances of pose and twist grow with
/// the time without limit, and with them what rounding does to the covariance.
bool is_somewhere(const PlacedObject& object) {
  const auto variances = object.covariance.diagonal().head<kLastSlowRow>();
  return is_valid_pose(object.pose) && object.twist.allFinite() && object.covariance.allFinite() &&
         variances.minCoeff() >= 0.0 && variances.maxCoeff() <= kLargestVariance;
}

}  // namespace

void MovingObjectState::lose_what_is_anywhere() {
  for (std::size_t h = hypotheses_.size(); h-- > 0;) {
    MovingHypothesis& hypothesis = hypotheses_[h];
    const Eigen::ArrayXd weights = hypothesis.weights.by_model();
    Eigen::ArrayXd lost = Eigen::ArrayXd::Zero(weights.size());
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < model_count(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      lost[row] = is_somewhere(hypothesis.objects[k]) ? 0.0 : 1.0;
      if (lost[row] == 0.0 && (!best || weights[row] > weights[static_cast<Eigen::Index>(*best)]))
        best = k;
    }
    if ((lost == 0.0).all()) continue;
    ModeWeights part = hypothesis.weights;
    part.scale(lost);
    lost_.add(part);
    hypothesis.weights.scale(1.0 - lost);
    if (!best) {
      drop(h);
      continue;
    }
    // A model has a Gaussian, whatever its weight.
    for (std::size_t k = 0; k < model_count(); ++k) {
      Matrix12d jacobian;
      if (lost[static_cast<Eigen::Index>(k)] > 0.0)
        hypothesis.objects[k] = as_of_model(hypothesis.objects[*best], *best, k, jacobian);
    }
  }
}

}  // namespace posemix::internal
