// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/noise_toml.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"

namespace posemix {
namespace {

template <class Vector>
std::string list_of(const Vector& v) {
  return fmt::format("[{}]", fmt::join(v, ", "));
}

const char* translation_key(NoiseFrame frame) {
  return frame == NoiseFrame::ray ? "translation_sd_of_range" : "translation_sd_m";
}

std::string deviations(const Vector6d& sd, NoiseFrame frame) {
  const Eigen::Vector3d rotation = sd.head<3>() / kRadPerDeg;
  const Eigen::Vector3d translation = sd.tail<3>();
  return fmt::format("rotation_sd_deg = {}, {} = {}", list_of(rotation), translation_key(frame),
                     list_of(translation));
}

std::string covariance_text(const Matrix6d& covariance, NoiseFrame frame) {
  if (covariance.isDiagonal(0.0))
    return deviations(Vector6d(covariance.diagonal().cwiseSqrt()), frame);
  std::vector<std::string> rows;
  for (const auto& row : covariance.rowwise()) rows.push_back(list_of(row));
  return fmt::format("covariance = {}", list_of(rows));
}

std::string component_text(const NoiseComponent& component) {
  std::string text =
      fmt::format("  {{weight = {}, frame = \"{}\", {}", component.weight, word_of(component.frame),
                  covariance_text(component.covariance, component.frame));
  if (component.run_length != 1.0) text += fmt::format(", run_length = {}", component.run_length);
  if (component.offset.log().norm() > 0.0) {
    const Eigen::Vector3d rotation = component.offset.rotation().log() / kRadPerDeg;
    const Eigen::Vector3d& translation = component.offset.translation();
    text += fmt::format(", offset = {{rotation_deg = {}, translation_m = {}}}", list_of(rotation),
                        list_of(translation));
  }
  return text + "},\n";
}

std::string slow_text(const SlowError& slow, NoiseFrame frame) {
  std::string text = covariance_text(slow.covariance, frame);
  if (std::isfinite(slow.correlation_angle_rad))
    text += fmt::format(", correlation_angle_deg = {}", slow.correlation_angle_rad / kRadPerDeg);
  if (std::isfinite(slow.correlation_time_s))
    text += fmt::format(", correlation_time_s = {}", slow.correlation_time_s);
  return "{" + text + "}";
}

std::string dependence_text(const DetectorNoise& noise) {
  const NoiseDependence& dependence = noise.dependence();
  const NoiseFrame frame = noise.components().front().frame;
  std::string text =
      fmt::format("slow = {}\n", dependence.slow ? slow_text(*dependence.slow, frame) : "\"none\"");
  if (dependence.common) {
    text +=
        fmt::format("common = {{{}}}\n", covariance_text(*dependence.common, NoiseFrame::object));
  }
  if (dependence.mode_time_s > 0.0)
    text += fmt::format("mode_time_s = {}\n", dependence.mode_time_s);
  if (dependence.is_typical) text += "is_typical = true\n";
  if (dependence.given_covariance != NoiseDependence{}.given_covariance)
    text += fmt::format("given_covariance = \"{}\"\n", word_of(dependence.given_covariance));
  return text;
}

bool is_bare_key(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}

/// The lines of the components and of clutter.
std::string model_text(std::string_view name, const DetectorNoise& noise) {
  if (name.empty() || !std::all_of(name.begin(), name.end(), is_bare_key)) {
    throw InvalidInput(
        fmt::format("noise model: the name is '{}', expected letters, digits, '_' and '-'", name));
  }
  std::string text = fmt::format("[noise.{}]\ncomponents = [\n", name);
  for (const NoiseComponent& component : noise.components()) text += component_text(component);
  text += "]\n";
  if (noise.clutter().weight > 0.0) {
    text += fmt::format("clutter = {{weight = {}, volume_m3 = {}}}\n", noise.clutter().weight,
                        noise.clutter().volume_m3);
  }
  return text;
}

}  // namespace

std::string format_noise_toml(std::string_view name, const DetectorNoise& noise) {
  return model_text(name, noise) + dependence_text(noise);
}

std::string format_odometry_toml(const OdometryNoise& noise) {
  require(!noise.windows.empty(), "the noise of an odometry is of no window");
  const auto list = [](const Vector6d& values, Eigen::Index from, double unit) {
    const Eigen::Vector3d part = values.segment<3>(from) / unit;
    return fmt::format("[{:.3g}]", fmt::join(part, ", "));
  };
  return fmt::format(
      "# A random walk of the odometry fitted to its error against the camera's truth in {}\n"
      "# recordings, over windows of {:.3g} to {:.3g} s. Standard errors {} deg, {} m, and {:.2g} "
      "m\n"
      "# of the scene's distance; jitter of the truth {} deg and {} m.\n"
      "[motion]\nmodel = \"odometry\"\n"
      "noise = {{per = \"second\", rotation_sd_deg = {}, translation_sd_m = {}, "
      "scene_distance_m = {:.3g}}}\n",
      noise.recordings, noise.windows.front().seconds, noise.windows.back().seconds,
      list(noise.sd_per_sqrt_s_error, 0, kRadPerDeg), list(noise.sd_per_sqrt_s_error, 3, 1.0),
      noise.scene_distance_error_m, list(noise.jitter_sd, 0, kRadPerDeg),
      list(noise.jitter_sd, 3, 1.0), list(noise.sd_per_sqrt_s, 0, kRadPerDeg),
      list(noise.sd_per_sqrt_s, 3, 1.0), noise.scene_distance_m);
}

}  // namespace posemix
