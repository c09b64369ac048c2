// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/simulation_folder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/slam/moving_objects.hpp"

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

/// The poses of the frames in which an object is there.
std::string tum_if_present(const SimulatedSequence& simulated, std::string_view transform,
                           const SimulatedObject& object, const auto& pose_at) {
  std::string text = fmt::format("# {}, simulated: stamp tx ty tz qx qy qz qw\n", transform);
  for (std::size_t k = 0; k < simulated.stamps_ns.size(); ++k) {
    if (!object.is_present(k)) continue;
    text += fmt::format("{} {}\n", seconds(simulated.stamps_ns[k]), numbers_of(pose_at(k), " "));
  }
  return text;
}

/// All detections, and what each is of, which no filter may see.
void add_sightings(const SimulatedSequence& simulated, std::map<std::string, std::string>& files) {
  std::string seen =
      "stamp_s,camera,detector,id,class,sighting,weight,tx_m,ty_m,tz_m,qx,qy,qz,qw\n";
  std::string sources = "sighting,stamp_s,source\n";
  std::size_t number = 0;
  for (std::size_t k = 0; k < simulated.sightings.size(); ++k) {
    const std::string stamp = seconds(simulated.stamps_ns[k]);
    for (const SimulatedSighting& sighting : simulated.sightings[k]) {
      seen += fmt::format("{},,,{},{},{},1,{}\n", stamp, sighting.object, sighting.class_id, number,
                          numbers_of(sighting.pose, ","));
      sources += fmt::format("{},{},{}\n", number, stamp,
                             sighting.source ? simulated.objects[*sighting.source].id : "");
      ++number;
    }
  }
  if (number == 0) throw InvalidInput("simulation: nothing is ever detected, expected detections");
  files["observations.csv"] = std::move(seen);
  files["sources.csv"] = std::move(sources);
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
  std::string text = fmt::format(
      "[camera]\n"
      "odometry = \"odometry.tum\"\n"
      "ground_truth = \"camera_truth.tum\"\n"
      "images = \"all\"\n"
      "\n"
      "[camera.start]\n"
      "pose = [{}]\n"
      "{}\n"
      "\n"
      "[motion]\n"
      "model = \"{}\"\n",
      numbers_of(simulated.camera_start, ", "), sd_text(claimed_start(config, simulated), "\n"),
      word_of(motion_settings(config).model));
  if (config.path.set_up == SimulationSetUp::still) return text;
  return text + fmt::format("noise = {{per = \"second\", {}}}\n",
                            sd_text(claimed_camera_error(config), ", "));
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

/// Standard deviations under `<prefix>rotation_sd_deg` and `<prefix>translation_sd_m`.
std::string sds_text(std::string_view prefix, const Vector6d& sds) {
  return fmt::format(", {0}rotation_sd_deg = {1}, {0}translation_sd_m = {2}", prefix,
                     array(sds.head<3>() / kRadPerDeg), array(sds.tail<3>()));
}

std::string model_text(const ObjectMotion& motion, const SimulationConfig& config) {
  std::string text = fmt::format("{{model = \"{}\"", name_of(motion));
  if (const auto* put = std::get_if<PutDownMotion>(&motion)) {
    text +=
        fmt::format(", jump_rate = {:.12g}, volume_m3 = {:.12g}", put->jump_rate, put->volume_m3);
  } else if (const auto* twist = std::get_if<ConstantVelocityMotion>(&motion)) {
    text += sds_text("acceleration_", twist->acceleration_sds);
    text += sds_text("start_", twist->start_sds);
    text += fmt::format(", frame = \"{}\"", word_of(twist->frame));
  } else if (const auto* held = std::get_if<AttachedMotion>(&motion)) {
    text += fmt::format(", frame = \"{}\"", config.frames[held->frame].name);
  }
  return text + "}";
}

/// The table [objects.motion]; none for an object that stands still.
std::string motion_text(const MotionModels& motion, const SimulationConfig& config) {
  if (is_static(motion)) return "";
  std::string text = "[objects.motion]\nmodels = [\n";
  for (const ObjectMotion& model : motion.models)
    text += fmt::format("  {},\n", model_text(model, config));
  text += "]\n";
  if (motion.rates.size() == 0) return text;
  text += "rates = [\n";
  for (Eigen::Index i = 0; i < motion.rates.rows(); ++i)
    text += fmt::format("  [{:.9g}],\n", fmt::join(motion.rates.row(i), ", "));
  return text + "]\n";
}

/// The truth of an object that names itself: one pose, or a file.
std::string truth_text(const SimulatedObject& object) {
  if (object.world_path.empty() && object.present.empty())
    return fmt::format("ground_truth = {{world_pose = [{}]}}\n",
                       numbers_of(object.world_truth, ", "));
  return fmt::format("ground_truth = {{world_tum = \"world_truth_{}.tum\"}}\n", object.id);
}

std::string object_text(const SimulationConfig& config, const SimulatedSequence& simulated,
                        std::size_t index) {
  const SimulationObject& settings = config.objects[index];
  const SimulatedObject& object = simulated.objects[index];
  std::string text = fmt::format("\n[noise.\"{}\"]\ncomponents = [\n", object.id);
  for (const SimulationNoise& noise : claimed_noise(settings)) text += component_text(noise);
  text += "]\n" + dependence_text(settings);
  const Clutter clutter = claimed_clutter_of(config, settings);
  text += fmt::format("clutter = {{weight = {:.12g}, volume_m3 = {:g}}}\n", clutter.weight,
                      clutter.volume_m3);
  text += fmt::format("\n[[objects]]\nid = \"{0}\"\nnoise = \"{0}\"\n", object.id);
  if (!object.class_id.empty()) text += fmt::format("class = \"{}\"\n", object.class_id);
  if (simulated.sightings.empty())
    text += fmt::format("detections = {{tum = \"detections_{}.tum\"}}\n", object.id);
  // Which instance of a class follows which object is not known before.
  if (object.class_id.empty()) text += truth_text(object);
  return text + motion_text(claimed_motion(config, settings), config);
}

/// A class with false detections has more instances than objects: one for each place that looks
/// like an object, and three for what is anywhere. Otherwise false ones would take the place of
/// true ones.
std::string spare_instances_text(const SimulationConfig& config) {
  std::map<std::string, std::size_t> spare;
  for (const SimulationClutter& clutter : config.clutter)
    if (!clutter.class_id.empty()) spare[clutter.class_id] += clutter.places.size() + 3;
  std::string text;
  for (const auto& [class_id, count] : spare) {
    const auto first = std::ranges::find(config.objects, class_id, &SimulationObject::class_id);
    if (first == config.objects.end()) continue;
    for (std::size_t k = 1; k <= count; ++k) {
      text +=
          fmt::format("\n[[objects]]\nid = \"{0}_spare_{1}\"\nnoise = \"{2}\"\nclass = \"{0}\"\n",
                      class_id, k, first->id);
      text += motion_text(claimed_motion(config, *first), config);
    }
  }
  return text;
}

std::string frame_text(const SimulatedFrame& frame) {
  return fmt::format("\n[[frames]]\nname = \"{0}\"\nposes = \"frame_{0}.tum\"\n{1}\n", frame.name,
                     sd_text(frame.error, "\n"));
}

std::string sequence_text(const SimulationFile& file, const SimulatedSequence& simulated,
                          std::uint64_t seed) {
  std::string text =
      fmt::format("# Simulated data: posemix simulate, seed {}.\nschema = 1\n\n", seed);
  text += camera_text(file.config, simulated);
  if (!simulated.sightings.empty()) text += "\n[[observations]]\ncsv = \"observations.csv\"\n";
  for (const SimulatedFrame& frame : simulated.frames) text += frame_text(frame);
  for (std::size_t i = 0; i < simulated.objects.size(); ++i)
    text += object_text(file.config, simulated, i);
  text += spare_instances_text(file.config);
  if (!file.filter.empty()) text += "\n[filter]\n";
  for (const auto& [key, value] : file.filter) text += fmt::format("{} = {}\n", key, value);
  return text;
}

}  // namespace

std::map<std::string, std::string> format_simulation(const SimulationFile& file,
                                                     const SimulatedSequence& simulated,
                                                     std::uint64_t seed) {
  validate(simulated);
  if (simulated.objects.size() != file.config.objects.size())
    throw InvalidInput(fmt::format("a simulation of {} objects for a configuration of {}",
                                   simulated.objects.size(), file.config.objects.size()));
  std::map<std::string, std::string> files;
  files["sequence.toml"] = sequence_text(file, simulated, seed);
  files["odometry.tum"] = tum(simulated, "T_odom_camera", simulated.odometry);
  files["camera_truth.tum"] = tum(simulated, "T_world_camera", simulated.camera_truth);
  for (const SimulatedObject& object : simulated.objects) {
    if (simulated.sightings.empty()) {
      files[fmt::format("detections_{}.tum", object.id)] =
          tum(simulated, "T_camera_object", object.detections);
    }
    files[fmt::format("truth_{}.tum", object.id)] =
        tum_if_present(simulated, "T_camera_object", object,
                       [&](std::size_t k) { return object.relative_truth[k]; });
    if (object.world_path.empty() && object.present.empty()) continue;
    files[fmt::format("world_truth_{}.tum", object.id)] = tum_if_present(
        simulated, "T_world_object", object, [&](std::size_t k) { return object.world_at(k); });
  }
  for (const SimulatedFrame& frame : simulated.frames) {
    files[fmt::format("frame_{}.tum", frame.name)] = tum(simulated, "T_world_frame", frame.given);
    files[fmt::format("frame_truth_{}.tum", frame.name)] =
        tum(simulated, "T_world_frame", frame.truth);
  }
  if (!simulated.sightings.empty()) add_sightings(simulated, files);
  return files;
}

}  // namespace posemix
