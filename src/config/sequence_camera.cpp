// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/io/text.hpp"
#include "sequence_parts.hpp"
#include "slam/searched_image.hpp"

namespace posemix::internal {
namespace {

/// The first entry of `lever_arms` whose range of names includes the sequence.
Eigen::Vector3d lever_arm_of_sequence(const TomlTable& root, const TomlTable& camera) {
  const std::string sequence = root.get_string("sequence");
  std::optional<Eigen::Vector3d> chosen;
  for (const TomlTable& range : camera.get_tables("lever_arms")) {
    const std::string from = range.get_string("from");
    const std::string to = range.get_string("to");
    const Eigen::Vector3d lever_arm = range.get_vector("lever_arm_m", 3, kPosition);
    if (!chosen && from <= sequence && sequence <= to) chosen = lever_arm;
  }
  if (!chosen)
    camera.fail("lever_arms", fmt::format("has no range that holds sequence '{}'", sequence));
  return *chosen;
}

Eigen::Vector3d read_lever_arm(const TomlTable& root, const TomlTable& camera) {
  const bool by_sequence = camera.has("lever_arms");
  if (by_sequence && camera.has("lever_arm_m")) {
    camera.fail("lever_arm_m", "stands beside lever_arms, expected one of the two");
  }
  if (by_sequence) return lever_arm_of_sequence(root, camera);
  return camera.get_vector_or("lever_arm_m", Eigen::VectorXd::Zero(3), kPosition);
}

ProcessNoise read_process_noise(const TomlTable& motion, std::string_view key,
                                const ProcessNoise& otherwise) {
  const auto table = motion.find_table(key);
  if (!table) return otherwise;
  const Eigen::Vector3d rotation = read_sd(*table, "rotation_sd_deg", kSdOrZero, kRadPerDeg);
  const Eigen::Vector3d translation = read_sd(*table, "translation_sd_m", kSdOrZero, 1.0);
  const double distance =
      table->get_double_or("scene_distance_m", 0.0, {.lowest = 0, .highest = 1e6});
  return {at_camera(pose_covariance(rotation, translation), distance),
          table->get_enum_or("per", otherwise.per)};
}

SE3d read_start_pose(const TomlTable& start, const Poses& camera_truth) {
  if (start.is_array("pose")) return read_pose(start, "pose");
  const bool known = !camera_truth.empty() && camera_truth.front();
  enum class Word { ground_truth, identity, unknown };
  const Word word =
      start.get_enum_or<Word>("pose", camera_truth.empty() ? Word::identity : Word::ground_truth,
                              {{"ground_truth", Word::ground_truth},
                               {"identity", Word::identity},
                               {"unknown", Word::unknown}});
  if (word != Word::ground_truth) return SE3d();
  if (!known) {
    start.fail("pose",
               "is \"ground_truth\", but camera.ground_truth has no pose at the first frame; give "
               "\"identity\" "
               "or seven numbers [tx, ty, tz, qx, qy, qz, qw]");
  }
  return *camera_truth.front();
}

/// The camera poses of a dataset's scene; its frames are all its images.
NumberedScene read_scene_truth(const TomlTable& truth, const FileFinder& files,
                               const SE3d& lever_arm) {
  const DatasetScene& scene = files.scene(truth);
  const auto poses = located(truth, truth.has("bop_dataset") ? "bop_dataset" : "ycb_video",
                             [&] { return scene.camera_poses(); });
  const std::set<std::int64_t> images = scene.image_ids();
  const std::int64_t first = read_first_frame(truth, scene.name, *images.begin());
  NumberedScene result{scene.name, {}};
  for (const std::int64_t image : images) {
    const auto pose = poses.find(image);
    result.poses[image - first] =
        pose == poses.end() ? std::nullopt : std::optional(pose->second * lever_arm);
  }
  return result;
}

PlacedStamp read_stamp(const LineReader& reader, std::string_view text) {
  const double stamp = reader.number_from(text, "stamp");
  if (std::abs(stamp) > kLatestStamp) reader.fail(fmt::format("stamp {}", stamp), "seconds");
  return {stamp, fmt::format("{}:{}", reader.name(), reader.number())};
}

/// Stamps, one per line.
std::vector<PlacedStamp> read_stamps(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  std::vector<PlacedStamp> stamps;
  LineReader reader(text, path.string());
  while (reader.next_content()) stamps.push_back(read_stamp(reader, trimmed(reader.line())));
  return stamps;
}

/// Every frame, or a file with a stamp and the name of a camera on every line.
ImageList read_images(const TomlTable& camera, const FileFinder& files) {
  if (camera.get_string("images") == "all") return {.all = true};
  const std::filesystem::path path = files.find(camera, "images");
  const std::string text = read_file(path);
  ImageList list;
  LineReader reader(text, path.string());
  while (reader.next_content()) {
    const std::string_view line = trimmed(reader.line());
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    list.images.push_back({.at = read_stamp(reader, line.substr(0, end)),
                           .camera = std::string(trimmed(line.substr(end)))});
  }
  return list;
}

}  // namespace

std::vector<std::vector<std::string>> ImageList::on(const Timeline& timeline,
                                                    const std::vector<BodyCamera>& cameras) const {
  std::vector<std::string> names;
  names.reserve(cameras.size() + 1);
  for (const BodyCamera& camera : cameras) names.push_back(camera.name);
  if (names.empty()) names.emplace_back();
  if (all) return std::vector(timeline.size(), names);
  std::vector<std::vector<std::string>> by_frame(timeline.size());
  for (const Image& image : images) {
    const auto frame = timeline.at_stamp(image.at.stamp);
    if (!frame) {
      throw InvalidInput(fmt::format("{}: got an image at stamp {} s, where {} has no frame",
                                     image.at.place, image.at.stamp, timeline.source()));
    }
    const auto searched = find_searched_image(cameras, image.camera);
    if (!searched || std::ranges::find(names, searched->camera) == names.end()) {
      throw InvalidInput(fmt::format("{}: got camera '{}', expected one of: '{}'", image.at.place,
                                     image.camera, fmt::join(names, "', '")));
    }
    by_frame[*frame].push_back(image.camera);
  }
  return by_frame;
}

void ImageList::require_known_detectors(const std::vector<BodyCamera>& cameras,
                                        const std::vector<ObjectModel>& models) const {
  const auto names = names_of_detectors(models);
  for (const Image& image : images) {
    try {
      require_known_detector(find_searched_image(cameras, image.camera).value_or(SearchedImage()),
                             names);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("{}: {}", image.at.place, error.what()));
    }
  }
}

CameraFiles read_camera_files(const TomlTable& root, const FileFinder& files) {
  CameraFiles result;
  const auto camera = root.find_table("camera");
  if (!camera) return result;
  result.frame_period_s = camera->get_double_or("frame_period_s", kFramePeriodS, kPeriod);
  if (camera->has("odometry")) {
    result.odometry = read_stamped(*camera, "odometry", files, {.allow_misses = true});
  }
  if (camera->has("stamps")) {
    if (!root.has("observations"))
      camera->fail("stamps",
                   "is for recordings with [[observations]]: others have frames by other files");
    result.stamps = read_stamps(files.find(*camera, "stamps"));
  }
  if (camera->has("images")) result.images = read_images(*camera, files);
  const SE3d lever_arm(SO3d(), read_lever_arm(root, *camera));
  if (camera->is_table("ground_truth")) {
    result.scene_truth = read_scene_truth(camera->get_table("ground_truth"), files, lever_arm);
  } else if (camera->has("ground_truth")) {
    result.truth = read_stamped(*camera, "ground_truth", files);
    for (StampedPose& frame : result.truth->poses) frame.pose = *frame.pose * lever_arm;
  }
  return result;
}

bool starts_anywhere(const TomlTable& root) {
  const auto camera = root.find_table("camera");
  const auto start = camera ? camera->find_table("start") : std::nullopt;
  return start && start->has("pose") && !start->is_array("pose") &&
         start->get_string("pose") == "unknown";
}

PoseDensity prior_anywhere(const TomlTable& root, const std::vector<ObjectModel>& models) {
  constexpr double kLeastDistance = 5.0;  // from what is known [m]
  std::vector<Eigen::Vector3d> known;
  for (const ObjectModel& model : models)
    if (model.prior) known.push_back(model.prior->world.mean().translation());
  const TomlTable start = root.get_table("camera").get_table("start");
  if (known.empty())
    start.fail("pose", "is \"unknown\", expected [[objects]] with a prior, from which it follows");
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& position : known) center += position / double(known.size());
  double farthest = kLeastDistance;
  for (const Eigen::Vector3d& position : known)
    farthest = std::max(farthest, (position - center).norm());
  // About the camera, of which all rotations are possible.
  const double translation = start.get_double_or("translation_sd_m", farthest, kSd);
  const SE3d pose(SO3d(), center);
  return PoseDensity(pose, pose.adjoint_congruence(pose_covariance(
                               Eigen::Vector3d::Constant(std::sqrt(kUniformRotationVariance)),
                               Eigen::Vector3d::Constant(translation))));
}

PoseDensity read_camera_prior(const TomlTable& root, const Poses& camera_truth) {
  Eigen::Vector3d rotation = Eigen::Vector3d::Constant(radians(kStartRotationSdDeg));
  Eigen::Vector3d translation = Eigen::Vector3d::Constant(kStartTranslationSdM);
  SE3d pose = camera_truth.empty() ? SE3d() : camera_truth.front().value_or(SE3d());
  const auto camera = root.find_table("camera");
  if (const auto start = camera ? camera->find_table("start") : std::nullopt) {
    pose = read_start_pose(*start, camera_truth);
    if (start->has("rotation_sd_deg")) {
      rotation = read_sd(*start, "rotation_sd_deg", kSd, kRadPerDeg);
    }
    if (start->has("translation_sd_m")) {
      translation = read_sd(*start, "translation_sd_m", kSd, 1.0);
    }
  }
  return PoseDensity(pose, pose_covariance(rotation, translation));
}

MotionSettings read_motion(const TomlTable& root, bool has_odometry) {
  MotionSettings settings;
  settings.model = has_odometry ? MotionModel::odometry : MotionModel::constant_velocity;
  const auto motion = root.find_table("motion");
  if (!motion) return settings;
  settings.model = motion->get_enum_or("model", settings.model);
  const bool needs_poses =
      settings.model == MotionModel::odometry || settings.model == MotionModel::given;
  if (needs_poses && !has_odometry) {
    motion->fail("model", fmt::format("is \"{}\", but there is no file under camera.odometry",
                                      word_of(settings.model)));
  }
  settings.period_s = motion->get_double_or("period_s", settings.period_s, kPeriod);
  ProcessNoise& noise = settings.model == MotionModel::random_walk ? settings.walk : settings.noise;
  noise = read_process_noise(*motion, "noise", noise);
  settings.motion_noise = read_process_noise(*motion, "motion_noise", settings.motion_noise);
  settings.unknown_motion = read_process_noise(*motion, "unknown_motion", settings.unknown_motion);
  return settings;
}

}  // namespace posemix::internal
