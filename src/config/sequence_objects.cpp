// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <initializer_list>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/io/bop.hpp"
#include "posemix/io/npy.hpp"
#include "posemix/io/object_poses.hpp"
#include "posemix/io/pose_table.hpp"
#include "posemix/io/text.hpp"
#include "sequence_parts.hpp"

namespace posemix::internal {
namespace {

constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();

/// The one of the keys that the table has; throws unless there is exactly one.
std::string_view the_one_of(const TomlTable& object, std::string_view key,
                            std::initializer_list<std::string_view> choices) {
  const TomlTable table = object.get_table(key);
  std::string_view chosen;
  std::size_t count = 0;
  for (const std::string_view choice : choices) {
    if (!table.has(choice)) continue;
    chosen = choice;
    ++count;
  }
  if (count == 1) return chosen;
  object.fail(key, fmt::format("has {} of the keys {}, expected one",
                               count == 0 ? "none" : "several", fmt::join(choices, ", ")));
}

/// Poses with frame numbers that are counted from zero.
std::map<std::int64_t, SE3d> from_first_frame(const TomlTable& table, const std::string& name,
                                              const std::map<std::int64_t, SE3d>& poses) {
  const std::int64_t least = poses.empty() ? kHighest : poses.begin()->first;
  const std::int64_t first = read_first_frame(table, name, least);
  std::map<std::int64_t, SE3d> shifted;
  for (const auto& [number, pose] : poses) {
    check_position(pose, fmt::format("{}: frame {}", name, number));
    shifted.emplace_hint(shifted.end(), number - first, pose);
  }
  return shifted;
}

DetectionFile read_tum_detections(const TomlTable& table, const FileFinder& files) {
  const TumOptions options{.allow_misses = true,
                           .zero_translation_is_miss = table.get_bool_or(
                               "zero_translation_is_miss", TumOptions{}.zero_translation_is_miss)};
  StampedFile file = read_stamped(table, "tum", files, options);
  return {std::move(file.name), std::move(file.poses), {}};
}

DetectionFile read_npy_detections(const TomlTable& table, const FileFinder& files) {
  const std::filesystem::path folder = files.find(table, "npy");
  const auto poses = posemix::read_npy_detections(folder, table.get_string("prefix"));
  return {folder.string(), std::nullopt, from_first_frame(table, folder.string(), poses)};
}

/// The poses in columns of a table: estimates with the prefix est_, or the truth with gt_.
DetectionFile read_table_poses(const TomlTable& table, const FileFinder& files,
                               const std::string& prefix) {
  const std::filesystem::path path = files.find(table, "pose_csv");
  const BopSelection selection{table.get_integer("scene", kAtLeastZero),
                               table.get_integer("object", kAtLeastZero)};
  const auto poses = read_pose_table(path, selection, prefix);
  return {path.string(), std::nullopt, from_first_frame(table, path.string(), poses)};
}

/// The truth at the images in the table; images after the last frame are left out.
Poses read_table_truth(const TomlTable& truth, const FileFinder& files, const Timeline& timeline) {
  Poses poses(timeline.size());
  for (const auto& [number, pose] : read_table_poses(truth, files, "gt_").numbered) {
    if (const auto frame = timeline.at_number(number)) poses[*frame] = pose;
  }
  return poses;
}

/// The truth at the images of a dataset's scene; images that are not frames are left out.
Poses read_scene_objects(const TomlTable& truth, std::string_view kind, const FileFinder& files,
                         const Timeline& timeline) {
  const DatasetScene& scene = files.scene(truth);
  const std::int64_t object = truth.get_integer("object", kAtLeastZero);
  std::optional<std::size_t> instance;
  if (truth.has("instance"))
    instance = static_cast<std::size_t>(truth.get_integer("instance", kAtLeastZero));
  const auto found = located(truth, kind, [&] { return scene.poses_of(object, instance); });
  Poses poses(timeline.size());
  for (const auto& [number, pose] : from_first_frame(truth, scene.name, found)) {
    if (const auto frame = timeline.at_number(number)) poses[*frame] = pose;
  }
  return poses;
}

SE3d read_entry(const TomlTable& truth, const FileFinder& files, const std::string& id) {
  const std::filesystem::path path = files.find(truth, "world_poses");
  const std::map<std::string, SE3d> poses = read_object_poses(path);
  const std::string entry = truth.get_string_or("entry", id);
  const auto found = poses.find(entry);
  if (found == poses.end()) {
    truth.fail("entry", fmt::format("is {}, which is not in {}", in_quotes(entry), path.string()));
  }
  return found->second;
}

}  // namespace

Poses DetectionFile::on(const Timeline& timeline) const {
  Poses detections(timeline.size());
  for (const auto& [number, pose] : numbered) detections[timeline.frame_of(number, name)] = pose;
  for (const StampedPose& record : stamped.value_or(std::vector<StampedPose>())) {
    const auto frame = timeline.at_stamp(record.stamp);
    if (frame) {
      detections[*frame] = record.pose;
    } else if (record.pose) {
      throw InvalidInput(fmt::format("{}: got a detection at stamp {} s, where {} has no frame",
                                     name, record.stamp, timeline.source()));
    }
  }
  return detections;
}

std::vector<CandidateFile> read_candidates(const TomlTable& root, const FileFinder& files) {
  std::vector<CandidateFile> candidates;
  for (const TomlTable& table : root.find_tables("candidates"))
    candidates.push_back(read_bop_candidates(table, files));
  return candidates;
}

std::optional<DetectionFile> read_detections(const TomlTable& object, const FileFinder& files,
                                             bool has_observations) {
  if (has_observations) {
    if (object.has("detections"))
      object.fail("detections", "stands beside [[observations]], expected one of the two");
    return std::nullopt;
  }
  if (object.has("class")) {
    for (const char* key : {"detections", "ground_truth"}) {
      if (object.has(key))
        object.fail(key,
                    "stands beside 'class', expected none: which of the instances the object "
                    "follows is not known before");
    }
    return std::nullopt;
  }
  const std::string_view kind = the_one_of(object, "detections", {"tum", "npy", "bop", "pose_csv"});
  const TomlTable table = object.get_table("detections");
  if (kind == "tum") return read_tum_detections(table, files);
  if (kind == "npy") return read_npy_detections(table, files);
  if (kind == "bop") return read_bop_detections(table, files);
  return read_table_poses(table, files, "est_");
}

void read_object_truth(const TomlTable& object, const FileFinder& files, const Timeline& timeline,
                       ObjectRecording& recording) {
  if (!object.has("ground_truth")) return;
  const std::string_view kind = the_one_of(object, "ground_truth",
                                           {"relative_tum", "pose_csv", "world_tum", "world_poses",
                                            "world_pose", "bop_dataset", "ycb_video"});
  const TomlTable truth = object.get_table("ground_truth");
  if (kind == "relative_tum") {
    recording.relative_truth = timeline.select(read_stamped(truth, kind, files));
  } else if (kind == "pose_csv") {
    recording.relative_truth = read_table_truth(truth, files, timeline);
  } else if (kind == "bop_dataset" || kind == "ycb_video") {
    recording.relative_truth = read_scene_objects(truth, kind, files, timeline);
  } else if (kind == "world_tum") {
    recording.world_truth = timeline.select(read_stamped(truth, kind, files));
  } else if (kind == "world_poses") {
    recording.world_truth = Poses(timeline.size(), read_entry(truth, files, recording.id));
  } else {
    recording.world_truth = Poses(timeline.size(), read_pose(truth, kind));
  }
}

}  // namespace posemix::internal
