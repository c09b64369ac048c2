// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/detector_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "lie/checked_noise.hpp"
#include "posemix/base/error.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "view_turn.hpp"

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

namespace {

/// Nearer than this the camera is at the object, and sees none of its sides [m]: the square is lost
/// to rounding.
constexpr double kLeastDistanceM = 1e-150;

/// The direction from the object to the camera along the object's axes; zero at the object.
Eigen::Vector3d view_direction(const SE3d& camera_object) {
  if (camera_object.translation().norm() < kLeastDistanceM) return Eigen::Vector3d::Zero();
  return -(camera_object.rotation().inverse() * camera_object.translation()).normalized();
}

}  // namespace

double view_angle(const SE3d& first, const SE3d& second) {
  const Eigen::Vector3d a = view_direction(first);
  const Eigen::Vector3d b = view_direction(second);
  if (a.isZero(0.0) || b.isZero(0.0)) return 0.0;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Eigen::Vector3d internal::view_turn(const SE3d& first, const SE3d& second) {
  const Eigen::Vector3d a = view_direction(first);
  const Eigen::Vector3d axis = a.cross(view_direction(second));
  const double sine = axis.norm();
  const double angle = view_angle(first, second);
  if (angle == 0.0) return Eigen::Vector3d::Zero();
  return sine > 0.0 ? Eigen::Vector3d(axis * (angle / sine)) : angle * a.unitOrthogonal();
}

NoiseAtPose noise_at(const NoiseComponent& noise, const SE3d& camera_object) {
  const SE3d mode = camera_object * noise.offset;
  switch (noise.frame) {
    case NoiseFrame::object:
      return {mode, noise.covariance};
    case NoiseFrame::camera:
      return {SE3d(SO3d(), mode.translation()), noise.covariance};
    case NoiseFrame::ray:
      break;
  }
  const auto [axes, range] = viewing_ray(mode);
  Vector6d units = Vector6d::Ones();
  units.tail<3>().setConstant(range);
  return {SE3d(axes, mode.translation()), with_range(noise.covariance, range), units};
}

NoiseComponent along_camera(const NoiseComponent& noise, const SE3d& camera_object) {
  if (noise.frame != NoiseFrame::ray) return noise;
  const NoiseAtPose at = noise_at(noise, camera_object);
  const SE3d turn(at.axes.rotation(), Eigen::Vector3d::Zero());
  NoiseComponent result = noise;
  result.frame = NoiseFrame::camera;
  result.covariance = turn.adjoint_congruence(at.covariance);
  return result;
}

namespace {

/// Throws InvalidInput when a number is not finite and above (or at) the bound.
void require_number(double value, double bound, bool or_equal, std::string_view name) {
  if (std::isfinite(value) && (or_equal ? value >= bound : value > bound)) return;
  throw InvalidInput(fmt::format("detector noise: {} is {}, expected a finite number {} {}", name,
                                 value, or_equal ? ">=" : ">", bound));
}

/// A length over which the slow error is correlated may be infinite.
void require_length(double value, std::string_view name) {
  if (value > 0.0) return;
  throw InvalidInput(fmt::format(
      "detector noise: {} of the slow error is {}, expected a positive number", name, value));
}

void check_dependence(NoiseDependence& dependence) {
  if (dependence.slow) {
    SlowError& slow = *dependence.slow;
    const std::string name = "detector noise: covariance of the slow error";
    slow.covariance = checked_covariance(slow.covariance, 6, name);
    check_variances(slow.covariance, name);
    require_length(slow.correlation_time_s, "correlation time");
    require_length(slow.correlation_angle_rad, "correlation angle");
  }
  if (dependence.common) {
    const std::string name = "detector noise: covariance of the error in common";
    dependence.common = internal::checked_noise(*dependence.common, name);
  }
  require_number(dependence.mode_time_s, 0.0, true, "mode time");
}

}  // namespace

DetectorNoise::DetectorNoise(std::vector<NoiseComponent> components, Clutter clutter,
                             NoiseDependence dependence)
    : components_(std::move(components)), clutter_(clutter), dependence_(std::move(dependence)) {
  require(!components_.empty(), "detector noise: there is no component");
  require_number(clutter_.weight, 0.0, true, "weight of clutter");
  require_number(clutter_.volume_m3, 0.0, false, "volume of clutter [m^3]");
  check_dependence(dependence_);
  double total = clutter_.weight;
  for (std::size_t i = 0; i < components_.size(); ++i) {
    NoiseComponent& component = components_[i];
    require_number(component.weight, 0.0, false, fmt::format("weight of component {}", i));
    check_pose(component.offset, fmt::format("detector noise: offset of component {}", i));
    require_number(component.run_length, 1.0, true, fmt::format("run length of component {}", i));
    if (dependence_.slow && component.frame != components_.front().frame) {
      throw InvalidInput(fmt::format(
          "detector noise: component {} has another frame than component 0, expected the same for "
          "all beside a slow error",
          i));
    }
    const std::string name = fmt::format("detector noise: covariance of component {}", i);
    component.covariance = checked_covariance(component.covariance, 6, name);
    check_variances(component.covariance, name);
    total += component.weight;
  }
  for (NoiseComponent& component : components_) component.weight /= total;
  clutter_.weight /= total;
}

bool DetectorNoise::is_white() const {
  return !dependence_.slow && !dependence_.common &&
         std::all_of(components_.begin(), components_.end(),
                     [](const NoiseComponent& c) { return c.run_length == 1.0; });
}

DetectorNoise DetectorNoise::as_white() const {
  if (is_white()) return *this;
  Matrix6d lasting = Matrix6d::Zero();
  if (dependence_.slow) lasting += dependence_.slow->covariance;
  if (dependence_.common) lasting += *dependence_.common;
  std::vector<NoiseComponent> components = components_;
  for (NoiseComponent& component : components) {
    component.covariance += lasting;
    component.run_length = 1.0;
  }
  return DetectorNoise(std::move(components), clutter_);
}

double DetectorNoise::log_clutter_density() const {
  constexpr double kPi = std::numbers::pi;
  return std::log(clutter_.weight) - std::log(8.0 * kPi * kPi * clutter_.volume_m3);
}

DetectorNoise DetectorNoise::single_gaussian() const {
  const DetectorNoise white = as_white();
  const auto is_centred = [](const NoiseComponent& component) {
    return component.offset.log().norm() < 1e-12;
  };
  const bool any_centred =
      std::any_of(white.components_.begin(), white.components_.end(), is_centred);
  NoiseComponent single;
  single.covariance.setZero();
  double total = 0.0;
  for (const NoiseComponent& component : white.components_) {
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
