// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/detector_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "posemix/base/error.hpp"

namespace posemix {

namespace {

constexpr double kLeastRangeM = 1e-3;

/// blkdiag(I, s I) C blkdiag(I, s I).
Matrix6d with_range(Matrix6d covariance, double range) {
  covariance.topRightCorner<3, 3>() *= range;
  covariance.bottomLeftCorner<3, 3>() *= range;
  covariance.bottomRightCorner<3, 3>() *= range * range;
  return covariance;
}

}  // namespace

ViewingRay viewing_ray(const SE3d& camera_mode) {
  const Eigen::Vector3d& ray = camera_mode.translation();
  const auto turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ray);
  return {SO3d::from_quaternion(turn), std::max(ray.norm(), kLeastRangeM)};
}

NoiseAtPose noise_at(const NoiseComponent& noise, const SE3d& camera_object) {
  const SE3d mode = camera_object * noise.offset;
  const Matrix6d& update = noise.update_covariance ? *noise.update_covariance : noise.covariance;
  switch (noise.frame) {
    case NoiseFrame::object:
      return {mode, noise.covariance, update};
    case NoiseFrame::camera:
      return {SE3d(SO3d(), mode.translation()), noise.covariance, update};
    case NoiseFrame::ray:
      break;
  }
  const auto [axes, range] = viewing_ray(mode);
  return {SE3d(axes, mode.translation()), with_range(noise.covariance, range),
          with_range(update, range)};
}

NoiseComponent along_camera(const NoiseComponent& noise, const SE3d& camera_object) {
  if (noise.frame != NoiseFrame::ray) return noise;
  const NoiseAtPose at = noise_at(noise, camera_object);
  const SE3d turn(at.axes.rotation(), Eigen::Vector3d::Zero());
  NoiseComponent result = noise;
  result.frame = NoiseFrame::camera;
  result.covariance = turn.adjoint_congruence(at.covariance);
  if (noise.update_covariance)
    result.update_covariance = turn.adjoint_congruence(at.update_covariance);
  return result;
}

DetectorNoise::DetectorNoise(std::vector<NoiseComponent> components, Clutter clutter,
                             NoiseDependence dependence)
    : components_(std::move(components)), clutter_(clutter), dependence_(std::move(dependence)) {
  if (dependence_.dependent_frames && !(*dependence_.dependent_frames >= 1.0)) {
    throw InvalidInput(fmt::format("detector noise: {} dependent frames, expected at least 1",
                                   *dependence_.dependent_frames));
  }
  if (dependence_.bias && !dependence_.bias->allFinite())
    throw InvalidInput("detector noise: the bias is not finite");
  require(!components_.empty(), "detector noise: there is no component");
  if (!(clutter_.weight >= 0.0) || !std::isfinite(clutter_.weight)) {
    throw InvalidInput(fmt::format(
        "detector noise: weight of clutter is {}, expected a finite number >= 0", clutter_.weight));
  }
  if (!(clutter_.volume_m3 > 0.0) || !std::isfinite(clutter_.volume_m3)) {
    throw InvalidInput(
        fmt::format("detector noise: volume of clutter is {} m^3, expected a positive number",
                    clutter_.volume_m3));
  }
  double total = clutter_.weight;
  for (std::size_t i = 0; i < components_.size(); ++i) {
    NoiseComponent& component = components_[i];
    if (!(component.weight > 0.0) || !std::isfinite(component.weight)) {
      throw InvalidInput(
          fmt::format("detector noise: weight of component {} is {}, expected a finite number > 0",
                      i, component.weight));
    }
    component.covariance = checked_covariance(
        component.covariance, 6, fmt::format("detector noise: covariance of component {}", i));
    if (component.update_covariance) {
      component.update_covariance =
          checked_covariance(*component.update_covariance, 6,
                             fmt::format("detector noise: update covariance of component {}", i));
    }
    total += component.weight;
  }
  for (NoiseComponent& component : components_) component.weight /= total;
  clutter_.weight /= total;
}

double DetectorNoise::log_clutter_density() const {
  constexpr double kPi = std::numbers::pi;
  return std::log(clutter_.weight) - std::log(8.0 * kPi * kPi * clutter_.volume_m3);
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

}  // namespace posemix
