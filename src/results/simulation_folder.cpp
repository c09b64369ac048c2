// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/simulation_folder.hpp"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

namespace posemix {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kBillion = 1'000'000'000;

/// Billionths as a decimal number with nine digits after the point.
std::string decimal(std::int64_t billionths) {
  const std::int64_t size = std::abs(billionths);
  return fmt::format("{}{}.{:09}", billionths < 0 ? "-" : "", size / kBillion, size % kBillion);
}

/// Nanoseconds as a decimal number of seconds without needless zeros.
std::string seconds(std::int64_t nanoseconds) {
  std::string text = decimal(nanoseconds);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

std::string numbers_of(const SimulatedPose& pose, std::string_view separator) {
  std::string text;
  for (const std::int64_t number : pose.billionths) {
    text += fmt::format("{}{}", text.empty() ? "" : separator, decimal(number));
  }
  return text;
}

std::string tum(const SimulatedSequence& simulated, std::string_view transform,
                const auto& pose_text) {
  std::string text = fmt::format("# {}, simulated: stamp tx ty tz qx qy qz qw\n", transform);
  for (std::size_t k = 0; k < simulated.stamps_ns.size(); ++k) {
    text += fmt::format("{} {}\n", seconds(simulated.stamps_ns[k]), pose_text(k));
  }
  return text;
}

std::string tum(const SimulatedSequence& simulated, std::string_view transform,
                const std::vector<SimulatedPose>& track) {
  return tum(simulated, transform, [&](std::size_t k) { return numbers_of(track[k], " "); });
}

std::string tum(const SimulatedSequence& simulated, std::string_view transform,
                const std::vector<std::optional<SimulatedPose>>& track) {
  return tum(simulated, transform, [&](std::size_t k) {
    return track[k] ? numbers_of(*track[k], " ") : std::string("0 0 0 0 0 0 0");
  });
}

/// A vector in TOML. Nine decimals hide rounding errors, which depend on the machine.
std::string array(const Vector3d& vector) {
  std::string text;
  for (const double value : vector) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ",
                        decimal(std::llround(value * static_cast<double>(kBillion))));
  }
  return "[" + text + "]";
}

std::string sd_text(const SimulationSd& sd, std::string_view separator,
                    std::string_view translation = "translation_sd_m") {
  return fmt::format("rotation_sd_deg = {}{}{} = {}", array(sd.rotation_rad / kRadPerDeg),
                     separator, translation, array(sd.translation_m));
}

std::string component_text(const SimulationNoise& noise) {
  const char* const translation =
      noise.frame == NoiseFrame::ray ? "translation_sd_of_range" : "translation_sd_m";
  std::string text = fmt::format("  {{weight = {:.12g}, frame = \"{}\", {}", noise.weight,
                                 word_of(noise.frame), sd_text(noise.sd, ", ", translation));
  if (!noise.offset_rotation_rad.isZero(0.0) || !noise.offset_translation_m.isZero(0.0)) {
    text += fmt::format(", offset = {{rotation_deg = {}, translation_m = {}}}",
                        array(noise.offset_rotation_rad / kRadPerDeg),
                        array(noise.offset_translation_m));
  }
  return text + "},\n";
}

std::string camera_text(const SimulationConfig& config, const SimulatedSequence& simulated) {
  return fmt::format(
      "[camera]\n"
      "odometry = \"odometry.tum\"\n"
      "ground_truth = \"camera_truth.tum\"\n"
      "\n"
      "[camera.start]\n"
      "pose = [{}]\n"
      "{}\n"
      "\n"
      "[motion]\n"
      "model = \"odometry\"\n"
      "noise = {{per = \"second\", {}}}\n",
      numbers_of(simulated.camera_start, ", "), sd_text(config.start, "\n"),
      sd_text(config.claimed_odometry.value_or(config.odometry), ", "));
}

std::string dependence_text(const SimulationObject& object) {
  const auto slow = claimed_slow_error(object);
  std::string text = "slow = \"none\"\n";
  if (slow) {
    const char* const translation = object.noise.front().frame == NoiseFrame::ray
                                        ? "translation_sd_of_range"
                                        : "translation_sd_m";
    text = fmt::format("slow = {{{}", sd_text(slow->sd, ", ", translation));
    if (std::isfinite(slow->correlation_s))
      text += fmt::format(", correlation_time_s = {:.12g}", slow->correlation_s);
    if (std::isfinite(slow->correlation_angle_rad)) {
      text += fmt::format(", correlation_angle_deg = {:.12g}",
                          slow->correlation_angle_rad / kRadPerDeg);
    }
    text += "}\n";
  }
  if (const double time = claimed_mode_time_s(object); time > 0.0)
    text += fmt::format("mode_time_s = {:.12g}\n", time);
  return text;
}

std::string object_text(const SimulationObject& settings, const SimulatedObject& object) {
  std::string text = fmt::format("\n[noise.\"{}\"]\ncomponents = [\n", object.id);
  for (const SimulationNoise& noise : claimed_noise(settings)) text += component_text(noise);
  text += "]\n" + dependence_text(settings);
  const Clutter clutter = claimed_clutter(settings);
  text += fmt::format("clutter = {{weight = {:.12g}, volume_m3 = {:g}}}\n", clutter.weight,
                      clutter.volume_m3);
  text += fmt::format(
      "\n"
      "[[objects]]\n"
      "id = \"{0}\"\n"
      "noise = \"{0}\"\n"
      "detections = {{tum = \"detections_{0}.tum\"}}\n"
      "ground_truth = {{world_pose = [{1}]}}\n",
      object.id, numbers_of(object.world_truth, ", "));
  return text;
}

std::string sequence_text(const SimulationFile& file, const SimulatedSequence& simulated,
                          std::uint64_t seed) {
  std::string text =
      fmt::format("# Simulated data: posemix simulate, seed {}.\nschema = 1\n\n", seed);
  text += camera_text(file.config, simulated);
  for (std::size_t i = 0; i < simulated.objects.size(); ++i) {
    text += object_text(file.config.objects[i], simulated.objects[i]);
  }
  if (!file.filter.empty()) text += "\n[filter]\n";
  for (const auto& [key, value] : file.filter) text += fmt::format("{} = {}\n", key, value);
  return text;
}

}  // namespace

std::map<std::string, std::string> format_simulation(const SimulationFile& file,
                                                     const SimulatedSequence& simulated,
                                                     std::uint64_t seed) {
  std::map<std::string, std::string> files;
  files["sequence.toml"] = sequence_text(file, simulated, seed);
  files["odometry.tum"] = tum(simulated, "T_odom_camera", simulated.odometry);
  files["camera_truth.tum"] = tum(simulated, "T_world_camera", simulated.camera_truth);
  for (const SimulatedObject& object : simulated.objects) {
    files[fmt::format("detections_{}.tum", object.id)] =
        tum(simulated, "T_camera_object", object.detections);
    files[fmt::format("truth_{}.tum", object.id)] =
        tum(simulated, "T_camera_object", object.relative_truth);
  }
  return files;
}

}  // namespace posemix
