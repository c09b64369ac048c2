// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/filter/multi_object_filter.hpp"
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
constexpr NumberRange kRunLength{.lowest = 1, .highest = 1e6};
constexpr NumberRange kCorrelation{.lowest = 0, .without_lowest = true, .with_infinity = true};
constexpr std::string_view kSeeSlow =
    "errors that successive detections have in common are stated under 'slow' of [noise.NAME]";

NoiseComponent read_component(const TomlTable& table) {
  NoiseComponent component;
  component.weight = table.get_double_or("weight", component.weight, kShare);
  component.frame = table.get_enum_or("frame", component.frame);
  component.covariance = read_covariance(table, component.frame, kSd);
  component.offset = read_offset(table);
  component.run_length = table.get_double_or("run_length", component.run_length, kRunLength);
  table.ignore_removed({"update"}, kSeeSlow);
  return component;
}

Clutter read_clutter(const TomlTable& model) {
  Clutter clutter;
  const auto table = model.find_table("clutter");
  if (!table) return clutter;
  clutter.weight = table->get_double("weight", {.lowest = 0, .highest = kShare.highest});
  clutter.volume_m3 = table->get_double_or("volume_m3", clutter.volume_m3, kShare);
  return clutter;
}

std::optional<SlowError> read_slow(const TomlTable& model, NoiseFrame frame) {
  if (!model.has("slow")) return std::nullopt;
  if (model.is_string("slow")) {
    model.get_enum<int>("slow", {{"none", 0}});
    return std::nullopt;
  }
  const TomlTable table = model.get_table("slow");
  SlowError slow;
  slow.covariance = read_covariance(table, frame, kSd);
  slow.correlation_time_s =
      table.get_double_or("correlation_time_s", slow.correlation_time_s, kCorrelation);
  slow.correlation_angle_rad = radians(table.get_double_or(
      "correlation_angle_deg", degrees(slow.correlation_angle_rad), kCorrelation));
  return slow;
}

NoiseDependence read_dependence(const TomlTable& model, NoiseFrame frame) {
  NoiseDependence dependence;
  dependence.slow = read_slow(model, frame);
  if (const auto common = model.find_table("common"))
    dependence.common = read_covariance(*common, NoiseFrame::object, kSdOrZero);
  dependence.mode_time_s =
      model.get_double_or("mode_time_s", dependence.mode_time_s, {.lowest = 0, .highest = 1e9});
  dependence.is_typical = model.get_bool_or("is_typical", dependence.is_typical);
  model.ignore_removed({"dependent_frames", "bias"}, kSeeSlow);
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

DetectorNoise internal::with_assumptions(const TomlTable& model, const DetectorNoise& noise) {
  DetectorNoise result = noise;
  if (!model.has("slow")) {
    result = with_assumed_slow_error(result);
    model.warn("slow",
               fmt::format("is missing: {:.0f} % of the variance of the noise is taken for a slow "
                           "error with a correlation angle of {:.0f} deg; state it, or "
                           "slow = \"none\" where successive detections are independent",
                           100.0 * kAssumedSlowFraction, degrees(kAssumedCorrelationAngle)));
  }
  if (!model.has("clutter")) {
    model.warn("clutter", fmt::format("is missing: detections are taken for clutter with "
                                      "probability {} (filter.default_clutter)",
                                      MultiObjectSettings{}.default_clutter));
  }
  return result;
}

std::map<std::string, DetectorNoise> internal::read_noise_models(const TomlTable& root,
                                                                 bool with_assumed) {
  std::map<std::string, DetectorNoise> models;
  const auto noise = root.find_table("noise");
  if (!noise) return models;
  for (const std::string& name : noise->keys()) {
    const TomlTable table = noise->get_table(name);
    const DetectorNoise stated = read_detector_noise(table);
    models.emplace(name, with_assumed ? with_assumptions(table, stated) : stated);
  }
  return models;
}

}  // namespace posemix
