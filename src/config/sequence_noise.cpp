// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/io/rigid.hpp"
#include "sequence_parts.hpp"

namespace posemix {
namespace {

using namespace internal;

SE3d read_offset(const TomlTable& component) {
  const auto offset = component.find_table("offset");
  if (!offset) return NoiseComponent{}.offset;
  constexpr NumberRange kRotationDeg{.lowest = -360, .highest = 360};
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  const Eigen::Vector3d rotation = offset->get_vector_or("rotation_deg", zero, kRotationDeg);
  const Eigen::Vector3d translation = offset->get_vector_or("translation_m", zero, kPosition);
  return SE3d(SO3d::exp(kRadPerDeg * rotation), translation);
}

/// Reads a covariance: standard deviations under `rotation_sd_deg` and `translation_sd_m` (for a
/// noise along the viewing ray `translation_sd_of_range`), or the whole matrix under `covariance`.
Matrix6d read_covariance(const TomlTable& table, NoiseFrame frame, const NumberRange& range) {
  const char* const translation =
      frame == NoiseFrame::ray ? "translation_sd_of_range" : "translation_sd_m";
  if (!table.has("covariance")) {
    return pose_covariance(read_sd(table, "rotation_sd_deg", range, kRadPerDeg),
                           read_sd(table, translation, range, 1.0));
  }
  for (const char* other : {"rotation_sd_deg", translation}) {
    if (table.has(other)) table.fail(other, "stands beside 'covariance', expected one");
  }
  return table.get_matrix("covariance", 6, 6);
}

constexpr NumberRange kShare{.lowest = 1e-12, .highest = 1e12};

NoiseComponent read_component(const TomlTable& table) {
  NoiseComponent component;
  component.weight = table.get_double_or("weight", component.weight, kShare);
  component.frame = table.get_enum_or("frame", component.frame);
  component.covariance = read_covariance(table, component.frame, kSd);
  component.offset = read_offset(table);
  if (const auto update = table.find_table("update"))
    component.update_covariance = read_covariance(*update, component.frame, kSd);
  return component;
}

Clutter read_clutter(const TomlTable& model) {
  Clutter clutter;
  const auto table = model.find_table("clutter");
  if (!table) return clutter;
  clutter.weight = table->get_double("weight", kShare);
  clutter.volume_m3 = table->get_double_or("volume_m3", clutter.volume_m3, kShare);
  return clutter;
}

NoiseDependence read_dependence(const TomlTable& model, NoiseFrame frame) {
  NoiseDependence dependence;
  if (model.has("dependent_frames"))
    dependence.dependent_frames = model.get_double("dependent_frames", {.lowest = 1});
  if (const auto bias = model.find_table("bias"))
    dependence.bias = read_covariance(*bias, frame, kSdOrZero);
  return dependence;
}

}  // namespace

Eigen::Vector3d internal::read_sd(const TomlTable& table, std::string_view key,
                                  const NumberRange& range, double unit) {
  if (table.is_array(key)) return unit * table.get_vector(key, 3, range);
  return Eigen::Vector3d::Constant(unit * table.get_double(key, range));
}

Matrix6d read_pose_covariance(const TomlTable& table) {
  const Eigen::Vector3d rotation = read_sd(table, "rotation_sd_deg", kSd, kRadPerDeg);
  const Eigen::Vector3d translation = read_sd(table, "translation_sd_m", kSd, 1.0);
  return pose_covariance(rotation, translation);
}

SE3d internal::read_pose(const TomlTable& table, std::string_view key) {
  const Eigen::VectorXd numbers = table.get_vector(key, 7, kPosition);
  const Eigen::Quaterniond quaternion(numbers[6], numbers[3], numbers[4], numbers[5]);
  const double norm = quaternion.coeffs().stableNorm();
  if (!(std::abs(norm - 1.0) <= kQuaternionNormTolerance)) {
    table.fail(
        key,
        fmt::format(
            "has a quaternion of norm {:.6g}, expected [tx, ty, tz, qx, qy, qz, qw] with norm 1",
            norm));
  }
  return SE3d(SO3d::from_quaternion(quaternion), numbers.head<3>());
}

DetectorNoise read_detector_noise(const TomlTable& model) {
  std::vector<NoiseComponent> components;
  for (const TomlTable& component : model.get_tables("components")) {
    components.push_back(read_component(component));
  }
  const Clutter clutter = read_clutter(model);
  const NoiseDependence dependence = read_dependence(
      model, components.empty() ? NoiseComponent{}.frame : components.front().frame);
  return located(model, "components",
                 [&] { return DetectorNoise(components, clutter, dependence); });
}

std::map<std::string, DetectorNoise> internal::read_noise_models(const TomlTable& root) {
  std::map<std::string, DetectorNoise> models;
  const auto noise = root.find_table("noise");
  if (!noise) return models;
  for (const std::string& name : noise->keys()) {
    models.emplace(name, read_detector_noise(noise->get_table(name)));
  }
  return models;
}

}  // namespace posemix
