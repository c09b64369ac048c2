// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/existence.hpp"

#include <algorithm>
#include <cmath>

#include "posemix/base/range.hpp"

namespace posemix {
namespace {

/// No evidence is larger: one detection is not surer than this [nats].
constexpr double kMostLogRatio = 12.0;

/// Probability of absence that stays whatever is seen, so that later images can still tell.
constexpr double kLeastAbsence = 1e-6;

}  // namespace

Existence::Existence(double birth_probability)
    : visible_(birth_probability), absent_(1.0 - birth_probability) {
  kOpenUnitInterval.check(birth_probability, "birth_probability");
}

void Existence::normalise() {
  const double sum = visible_ + hidden_ + absent_;
  visible_ /= sum;
  hidden_ /= sum;
  absent_ = std::max(absent_ / sum, kLeastAbsence);
}

void Existence::predict(double dt, const ExistenceSettings& settings) {
  const double stays = std::exp(-dt / settings.lifetime_s);
  const double changes = 0.5 * (1.0 - std::exp(-2.0 * dt / settings.occlusion_time_s));
  const double visible = (1.0 - changes) * visible_ + changes * hidden_;
  hidden_ = stays * ((1.0 - changes) * hidden_ + changes * visible_);
  visible_ = stays * visible;
  absent_ = 1.0 - visible_ - hidden_;
  normalise();
}

void Existence::update(const ExistenceEvidence& evidence, const ExistenceSettings& settings) {
  // Relative to the density of the same detections as clutter, which is all under "hidden" and
  // "does not exist".
  const double missed = 1.0 - settings.detection_probability;
  const double confused = settings.confusion_probability;
  const auto detected = [&](double log_ratio, double share) {
    return share * settings.detection_probability * std::exp(std::min(log_ratio, kMostLogRatio));
  };
  double likelihood = evidence.in_view ? missed : 1.0;
  if (evidence.log_ratio) likelihood = missed + detected(*evidence.log_ratio, 1.0 - confused);
  if (evidence.log_confused) {
    const double other = missed + detected(*evidence.log_confused, confused);
    likelihood = evidence.log_ratio ? std::max(likelihood, other) : other;
  }
  visible_ *= likelihood;
  normalise();
}

void FieldOfView::add(const Eigen::Vector3d& position) {
  if (!(position.z() > 0.0)) return;
  box_.extend(Eigen::Vector2d(position.head<2>() / position.z()));
  farthest_ = std::max(farthest_, position.z());
}

bool FieldOfView::contains(const Eigen::Vector3d& position) const {
  return position.z() > 0.0 && position.z() <= farthest_ &&
         box_.contains(Eigen::Vector2d(position.head<2>() / position.z()));
}

}  // namespace posemix
