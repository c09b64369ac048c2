// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/default_noise.hpp"
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
  if (table.has("covariance"))
    located(table, "covariance", [&] { checked_covariance(slow.covariance, 6, "the slow error"); });
  slow.correlation_time_s =
      table.get_double_or("correlation_time_s", slow.correlation_time_s, kCorrelation);
  slow.correlation_angle_rad = radians(table.get_double_or(
      "correlation_angle_deg", degrees(slow.correlation_angle_rad), kCorrelation));
  return slow;
}

NoiseDependence read_dependence(const TomlTable& model, NoiseFrame frame) {
  NoiseDependence dependence;
  dependence.slow = read_slow(model, frame);
  if (const auto common = model.find_table("common")) {
    dependence.common = read_covariance(*common, NoiseFrame::object, kSdOrZero);
    if (common->has("covariance")) {
      located(*common, "covariance",
              [&] { checked_covariance(*dependence.common, 6, "the error in common"); });
    }
  }
  dependence.mode_time_s =
      model.get_double_or("mode_time_s", dependence.mode_time_s, {.lowest = 0, .highest = 1e9});
  dependence.is_typical = model.get_bool_or("is_typical", dependence.is_typical);
  dependence.given_covariance = model.get_enum_or("given_covariance", dependence.given_covariance);
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

namespace {

/// What is assumed of the slow error, for the warning.
std::string assumed_slow_error(const DetectorNoise& stated, const DetectorNoise& assumed) {
  const auto& slow = assumed.dependence().slow;
  if (!slow) {
    return "is missing: the errors of successive detections are taken for independent, because the "
           "components have different frames";
  }
  const double fraction = slow->covariance(0, 0) / stated.components().front().covariance(0, 0);
  return fmt::format(
      "is missing: {:.3g} % of the variance of the first component is taken for a slow error with "
      "a correlation angle of {:.0f} deg; state it, or slow = \"none\" where successive detections "
      "are independent",
      100.0 * fraction, degrees(slow->correlation_angle_rad));
}

/// The noise of the table `model` with what is assumed where keys are missing, and a warning for
/// each.
DetectorNoise with_assumptions(const TomlTable& model, const DetectorNoise& noise,
                               double default_clutter) {
  DetectorNoise result = noise;
  if (!model.has("slow")) {
    result = with_assumed_slow_error(result);
    model.warn("slow", assumed_slow_error(noise, result));
  }
  if (!model.has("clutter")) {
    model.warn("clutter",
               default_clutter > 0.0
                   ? fmt::format("is missing: detections are taken for clutter with probability {} "
                                 "(filter.default_clutter)",
                                 default_clutter)
                   : "is missing, and filter.default_clutter is 0: no detection but the first "
                     "starts a hypothesis");
  }
  return result;
}

}  // namespace

std::map<std::string, DetectorNoise> internal::read_noise_models(const TomlTable& root) {
  std::map<std::string, DetectorNoise> models;
  const auto noise = root.find_table("noise");
  if (!noise) return models;
  for (const std::string& name : noise->keys())
    models.emplace(name, read_detector_noise(noise->get_table(name)));
  return models;
}

void internal::assume_missing(const TomlTable& root, const std::set<std::string>& used,
                              double default_clutter,
                              std::map<std::string, DetectorNoise>& models) {
  for (auto& [name, noise] : models) {
    if (!used.contains(name)) continue;
    noise = with_assumptions(root.get_table("noise").get_table(name), noise, default_clutter);
  }
}

}  // namespace posemix
