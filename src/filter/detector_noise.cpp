// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/detector_noise.hpp"

#include <algorithm>
#include <utility>

namespace posemix {

DetectorNoise::DetectorNoise(std::vector<NoiseComponent> components)
    : components_(std::move(components)) {
  require(!components_.empty(), "detector noise: there is no component");
  double total = 0.0;
  for (std::size_t i = 0; i < components_.size(); ++i) {
    NoiseComponent& component = components_[i];
    if (!(component.weight > 0.0) || !std::isfinite(component.weight)) {
      throw InvalidInput(
          fmt::format("detector noise: weight of component {} is {}, expected a finite number > 0",
                      i, component.weight));
    }
    component.covariance = checked_covariance(
        component.covariance, 6, fmt::format("detector noise: covariance of component {}", i));
    total += component.weight;
  }
  for (NoiseComponent& component : components_) component.weight /= total;
}

DetectorNoise DetectorNoise::single_gaussian() const {
  const auto is_centred = [](const NoiseComponent& component) {
    return component.offset.log().norm() < 1e-12;
  };
  const bool any_centred = std::any_of(components_.begin(), components_.end(), is_centred);
  NoiseComponent single;
  single.covariance.setZero();
  double total = 0.0;
  for (const NoiseComponent& component : components_) {
    if (any_centred && !is_centred(component)) continue;
    if (total > 0.0 && component.frame != single.frame) {
      throw InvalidInput(
          "detector noise: components in different frames have no common single Gaussian");
    }
    single.frame = component.frame;
    total += component.weight;
    single.covariance += component.weight * component.covariance;
  }
  single.covariance /= total;
  return DetectorNoise({single});
}

Matrix6d pose_covariance(const Eigen::Vector3d& rotation_sd_rad,
                         const Eigen::Vector3d& translation_sd_m) {
  Vector6d sd;
  sd << rotation_sd_rad, translation_sd_m;
  return sd.cwiseAbs2().asDiagonal();
}

}  // namespace posemix
