// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "fiducials.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/fiducial/fiducial_folder.hpp"
#include "posemix/fiducial/tag_odometry.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/text.hpp"
#include "summary.hpp"
#include "usage_error.hpp"

namespace posemix {
namespace {

// Beyond these nothing is a tag that a camera sees, or an error of its corners.
constexpr NumberRange kTagSize{.lowest = 1e-4, .highest = 1e3};
constexpr NumberRange kPixelError{.lowest = 1e-6, .highest = 1e4};
constexpr NumberRange kSharedPixelError{.lowest = 0.0, .highest = 1e4};
constexpr NumberRange kDegreesOfFreedom{.lowest = 0.1, .highest = 1e9};

struct FiducialOptions {
  std::string corners;
  std::string cameras;
  std::string camera_poses;
  std::string tags;
  std::optional<double> size;
  std::string odometry;
  std::optional<double> noise;
  std::optional<double> dof;
  FiducialSettings settings;
  double survey_rotation_deg = 1.0;
  double survey_position_m = 0.01;
  bool gzip = false;
  OutputOptions output;
};

std::vector<RigCamera> cameras_of(const FiducialOptions& options) {
  std::vector<RigCamera> cameras = read_cameras(options.cameras);
  if (!options.camera_poses.empty()) read_camera_poses(options.camera_poses, cameras);
  return cameras;
}

TagMap tags_of(const FiducialOptions& options) {
  if (options.tags.empty() && !options.size)
    throw UsageError("the size of the tags is unknown, expected --size or --tags");
  TagMap tags;
  if (!options.tags.empty()) tags = read_tag_map(options.tags);
  if (options.size) tags.default_size_m = options.size;
  return tags;
}

FiducialSettings settings_of(const FiducialOptions& options) {
  FiducialSettings settings = options.settings;
  if (options.noise) {
    settings.noise = CornerNoise{.sd_px = *options.noise};
    if (options.dof) settings.noise->dof = *options.dof;
  }
  return settings;
}

Json summary_of(const FiducialFolder& folder) {
  const Fiducials& fiducials = folder.fiducials;
  std::set<std::string> tags;
  for (const Observation& observation : fiducials.observations) tags.insert(observation.object);
  Json found = {{"sightings", fiducials.sightings},
                {"of_ignored_tags", fiducials.ignored},
                {"of_tags_without_size", fiducials.without_size},
                {"without_pose", fiducials.without_pose},
                {"observations", fiducials.observations.size()},
                {"tags", tags.size()},
                {"tags_with_prior", folder.tags.priors.size()}};
  const double ambiguous = static_cast<double>(ambiguous_count(fiducials.observations));
  const std::size_t count = fiducials.observations.size();
  found["ambiguous_share"] = count == 0 ? 0.0 : ambiguous / static_cast<double>(count);
  for (const CameraCornerNoise& camera : fiducials.noise) {
    found["corner_noise"][camera.camera] = {{"sd_px", camera.noise.sd_px},
                                            {"dof", camera.noise.dof},
                                            {"sightings", camera.sightings},
                                            {"source", word_of(camera.source)}};
  }
  return found;
}

/// Odometry on another clock would say nothing of any sighting.
void require_one_clock(const FiducialFolder& folder, const std::string& name) {
  if (folder.odometry.empty()) return;
  const auto [first, last] =
      std::minmax_element(folder.odometry.begin(), folder.odometry.end(),
                          [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  for (const Observation& seen : folder.fiducials.observations)
    if (seen.stamp_s >= first->stamp && seen.stamp_s <= last->stamp) return;
  throw InvalidInput(
      fmt::format("{}: goes from stamp {} s to {} s, expected the clock of the corners, whose "
                  "first stamp is {} s",
                  name, first->stamp, last->stamp, folder.fiducials.observations.front().stamp_s));
}

/// A folder without observations would be of no use.
void require_placed(const FiducialFolder& folder, const std::string& name) {
  std::set<std::string> placed;
  for (const RigCamera& camera : folder.cameras)
    if (camera.rig_camera) placed.insert(camera.name);
  for (const Observation& seen : folder.fiducials.observations)
    if (placed.contains(seen.camera)) return;
  throw InvalidInput(fmt::format(
      "{}: no camera with a pose on the rig sees a tag, expected one: see --camera-poses", name));
}

/// Odometry in other units or on a late clock agrees with the tags by a large noise alone.
void doubt_odometry(const FiducialFolder& folder, const std::string& name) {
  constexpr double kHardlyRotation = 0.2;     // rad / sqrt(s)
  constexpr double kHardlyTranslation = 0.5;  // m / sqrt(s)
  const auto noise =
      fit_tag_odometry(folder.fiducials.observations, folder.cameras, folder.odometry);
  if (!noise) return;
  if (noise->rotation_sd < kHardlyRotation && noise->translation_sd < kHardlyTranslation) return;
  print_warnings(
      {fmt::format("{}: against the tags it errs by {:.3g} deg and {:.3g} m per square root of a "
                   "second, which is hardly odometry (unit, clock or T_body_odom?)",
                   name, noise->rotation_sd / kRadPerDeg, noise->translation_sd)});
}

int write_fiducials(const FiducialOptions& options) {
  FiducialFolder folder;
  folder.cameras = cameras_of(options);
  folder.tags = tags_of(options);
  if (!options.odometry.empty()) {
    folder.odometry =
        odometry_of_rig(parse_tum(read_file_or_gzip(options.odometry), options.odometry),
                        folder.tags.rig_odometry.value_or(SE3d()));
  }
  folder.compress = options.gzip;
  folder.sequence = {radians(options.survey_rotation_deg), options.survey_position_m};
  folder.fiducials = observe_fiducials(read_corners(options.corners), folder.cameras, folder.tags,
                                       settings_of(options));
  if (folder.fiducials.observations.empty()) {
    const Fiducials& found = folder.fiducials;
    throw InvalidInput(fmt::format(
        "{}: got no observation of {} sightings ({} of ignored tags, {} of tags without a size, {} "
        "whose corners are no image of a tag's front), expected some: see --order, --size and "
        "--tags",
        options.corners, found.sightings, found.ignored, found.without_size, found.without_pose));
  }
  require_one_clock(folder, options.odometry);
  print_warnings(folder.fiducials.warnings);
  for (const std::string& camera : complete_rig(folder)) {
    print_warnings(
        {fmt::format("camera {} has no pose on the rig and sees no tag together with one "
                     "that has, so that its observations are left out",
                     in_quotes(camera))});
  }
  require_placed(folder, options.corners);
  if (!options.odometry.empty()) doubt_odometry(folder, options.odometry);
  write_fiducial_folder(folder, options.output.out);
  report("fiducials", summary_of(folder), options.output);
  return kExitDone;
}

void add_input_options(CLI::App& command, FiducialOptions& options) {
  command.add_option("corners", options.corners, "Corners of the tags, of gzip or not")
      ->required()
      ->check(not_empty)
      ->type_name("CORNERS.csv");
  command.add_option("--cameras", options.cameras, "Intrinsics, as TagSLAM or kalibr writes them")
      ->required()
      ->check(not_empty)
      ->type_name("CAMERAS.yaml");
  command
      .add_option("--camera-poses", options.camera_poses,
                  "Poses of the cameras on their rig, as TagSLAM writes them")
      ->check(not_empty)
      ->type_name("CAMERA_POSES.yaml");
  command
      .add_option("--tags", options.tags, "Sizes and known poses of tags, as TagSLAM reads them")
      ->check(not_empty)
      ->type_name("TAGSLAM.yaml");
  command
      .add_option("--size", options.size, "Edge of every tag [m]; with --tags of those not in it")
      ->check(number_in(kTagSize))
      ->type_name("M");
  command
      .add_option("--odometry", options.odometry,
                  "Odometry of the rig, or of T_body_odom of --tags (TUM)")
      ->check(not_empty)
      ->type_name("ODOMETRY.tum");
}

void add_setting_options(CLI::App& command, FiducialOptions& options) {
  add_choice<CornerOrder>(command, "--order", options.settings.order, "Order of the corners")
      ->default_str("apriltag");
  CLI::Option* const noise =
      command
          .add_option("--corner-noise", options.noise,
                      "Scale of the noise of a corner's coordinate [px]; learned without it")
          ->check(number_in(kPixelError))
          ->type_name("PX");
  command
      .add_option("--corner-dof", options.dof,
                  "Its degrees of freedom (Student's t); without it, it is normal")
      ->check(number_in(kDegreesOfFreedom))
      ->needs(noise)
      ->type_name("N");
  command
      .add_option("--bearing-error", options.settings.bearing_sd_px,
                  "Error that all corners of a sighting share [px], as of calibrations")
      ->check(number_in(kSharedPixelError))
      ->type_name("PX")
      ->capture_default_str();
  command
      .add_option("--survey-rotation", options.survey_rotation_deg,
                  "Least standard deviation of the rotations of known tags [deg]")
      ->check(number_in(kPositive))
      ->type_name("DEG")
      ->capture_default_str();
  command
      .add_option("--survey-position", options.survey_position_m,
                  "Least standard deviation of the positions of known tags [m]")
      ->check(number_in(kPositive))
      ->type_name("M")
      ->capture_default_str();
  command.add_option("--detector", options.settings.detector, "Name of the detector")
      ->type_name("NAME");
}

}  // namespace

void add_fiducials_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<FiducialOptions>();
  CLI::App* command = program.add_subcommand(
      "fiducials", "Observations with both poses of square tags from their corners");
  command->footer(
      "A square tag has two poses that fit its corners nearly as well. Writes both, with weights\n"
      "and covariances that follow from the reprojection errors and from the noise of the "
      "corners,\n"
      "which is learned from the recording per camera.\n"
      "\n"
      "CORNERS.csv has the columns stamp_s,topic,tag,u0_px,v0_px,...,u3_px,v3_px in distorted\n"
      "pixels. DIR gets sequence.toml, which posemix slam takes, observations.csv, cameras.csv,\n"
      "corner_noise.csv, tag_priors.csv (known poses of tags) and odometry.tum; it appears as a\n"
      "whole. Cameras without a pose on the rig get one from tags that they see together with "
      "others.\n"
      "\n"
      "Example: posemix fiducials corners.csv.gz --cameras cameras.yaml \\\n"
      "           --camera-poses camera_poses.yaml --tags tagslam.yaml --out out/tags\n"
      "         posemix fiducials corners.csv --cameras camchain.yaml --size 0.15 --out out/tags");
  add_input_options(*command, *options);
  add_setting_options(*command, *options);
  command->add_flag("--gzip", options->gzip, "Compress the observations");
  command->add_option("-o,--out", options->output.out, "Folder for the result")
      ->required()
      ->type_name("DIR");
  command->add_flag("--json", options->output.json, "Report one line of JSON instead of a table");
  command->add_flag("--quiet", options->output.quiet, "Do not report");
  command->callback(
      [options, &action] { action = [options] { return write_fiducials(*options); }; });
}

}  // namespace posemix
