// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/units.hpp"
#include "study.hpp"

/// Noise models as text. The keys are those that read_detector_noise knows.
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
      fmt::format("  {{weight = {}, frame = \"{}\", {}", component.weight, name_of(component.frame),
                  covariance_text(component.covariance, component.frame));
  if (component.update_covariance) {
    text += fmt::format(", update = {{{}}}",
                        covariance_text(*component.update_covariance, component.frame));
  }
  if (component.offset.log().norm() > 0.0) {
    const Eigen::Vector3d rotation = component.offset.rotation().log() / kRadPerDeg;
    const Eigen::Vector3d& translation = component.offset.translation();
    text += fmt::format(", offset = {{rotation_deg = {}, translation_m = {}}}", list_of(rotation),
                        list_of(translation));
  }
  return text + "},\n";
}

std::string correlation_text(const NoiseCorrelation& correlation, NoiseFrame frame) {
  std::string text;
  if (std::isfinite(correlation.inlier.within)) {
    text +=
        fmt::format("# Whole recordings with their biases: {:.3g}.\ndependent_frames = {:.3g}\n",
                    correlation.inlier.about_zero, correlation.inlier.within);
  }
  if (correlation.bias_sd.allFinite()) {
    const Vector6d& sd = correlation.bias_sd;
    const Eigen::Vector3d rotation = sd.head<3>() / kRadPerDeg;
    const Eigen::Vector3d translation = sd.tail<3>();
    text += fmt::format("bias = {{rotation_sd_deg = [{:.3g}], {} = [{:.3g}]}}\n",
                        fmt::join(rotation, ", "), translation_key(frame),
                        fmt::join(translation, ", "));
  }
  return text;
}

}  // namespace

std::string format_noise_toml(std::string_view name, const DetectorNoise& noise,
                              const NoiseCorrelation* correlation) {
  std::string text = fmt::format("[noise.{}]\ncomponents = [\n", name);
  for (const NoiseComponent& component : noise.components()) text += component_text(component);
  text += "]\n";
  if (noise.clutter().weight > 0.0) {
    text += fmt::format("clutter = {{weight = {}, volume_m3 = {}}}\n", noise.clutter().weight,
                        noise.clutter().volume_m3);
  }
  if (correlation != nullptr)
    text += correlation_text(*correlation, noise.components().front().frame);
  return text;
}

}  // namespace posemix
