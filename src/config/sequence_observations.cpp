// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/gzip.hpp"
#include "sequence_parts.hpp"

/// Observations, the cameras of a body, and objects on sight.
namespace posemix::internal {
namespace {

/// Odometry further apart than this is not interpolated [s].
constexpr double kLongestGap = 1.0;

/// Reads the file under `csv` or `jsonl`.
ObservationFile read_observation_file(const TomlTable& table, const FileFinder& files) {
  const bool lines = table.has("jsonl");
  if (lines && table.has("csv")) table.fail("jsonl", "stands beside csv, expected one of the two");
  const std::filesystem::path path = files.find(table, lines ? "jsonl" : "csv");
  const std::string text = read_file_or_gzip(path);
  PlacedObservations placed =
      lines ? parse_placed_lines(text, path.string()) : parse_placed_table(text, path.string());
  return {path.string(), std::move(placed.observations), std::move(placed.lines)};
}

/// The best component of an observation as it is from the body.
SE3d from_body(const Observation& observation, const std::vector<BodyCamera>& cameras) {
  const SE3d& pose = observation.components[best_component(observation)].pose;
  // A product with the identity may differ in the last bit.
  return cameras.empty() ? pose : pose_on_body(cameras, observation.camera) * pose;
}

}  // namespace

std::vector<ObservationFile> read_observation_files(const TomlTable& root,
                                                    const FileFinder& files) {
  std::vector<ObservationFile> list;
  for (const TomlTable& table : root.find_tables("observations")) {
    ObservationFile file = read_observation_file(table, files);
    const auto key_of = [&](std::string_view key) {
      return table.has(key) ? fmt::format("{}: key 'observations.{}'", table.location(key), key)
                            : std::string();
    };
    file.camera_key = key_of("camera");
    file.detector_key = key_of("detector");
    for (Observation& observation : file.observations) {
      observation.camera = table.get_string_or("camera", observation.camera);
      observation.detector = table.get_string_or("detector", observation.detector);
    }
    list.push_back(std::move(file));
  }
  return list;
}

/// Of n of T_body_camera Exp(n); none where the file states none.
std::optional<Matrix6d> read_camera_covariance(const TomlTable& table) {
  const bool has_deviations = table.has("rotation_sd_deg") || table.has("translation_sd_m");
  if (table.has("covariance")) {
    if (has_deviations)
      table.fail("covariance", "stands beside standard deviations, expected one of the two");
    Matrix6d stated = table.get_matrix("covariance", 6, 6);
    if (stated.isZero(0.0)) return stated;  // exact
    try {
      return checked_covariance(stated, 6, "");
    } catch (const InvalidInput& error) {
      table.fail("covariance", fmt::format("{}, expected a symmetric positive definite one",
                                           trimmed(error.what())));
    }
  }
  if (!has_deviations) return std::nullopt;
  const Eigen::Vector3d rotation = read_sd(table, "rotation_sd_deg", kSdOrZero, kRadPerDeg);
  const Eigen::Vector3d translation = read_sd(table, "translation_sd_m", kSdOrZero, 1.0);
  const bool exact = rotation.isZero(0.0) && translation.isZero(0.0);
  for (const char* key : {"rotation_sd_deg", "translation_sd_m"}) {
    const Eigen::Vector3d& sd = key[0] == 'r' ? rotation : translation;
    if (!exact && sd.minCoeff() == 0.0)
      table.fail(key,
                 "has a zero beside deviations above zero, expected all of both keys zero "
                 "(exact) or all above zero");
  }
  return pose_covariance(rotation, translation);
}

std::vector<BodyCamera> read_body_cameras(const TomlTable& root) {
  std::vector<BodyCamera> cameras;
  for (const TomlTable& table : root.find_tables("cameras")) {
    cameras.push_back(
        {table.get_string("name"), read_pose(table, "pose"), read_camera_covariance(table)});
    located(table, "name", [&] { require_valid(cameras); });
  }
  return cameras;
}

std::vector<std::string> ids_on_sight(const std::vector<ObservationFile>& files,
                                      const std::vector<std::string>& declared) {
  // By their first stamp, then by name, whatever the order of rows and files.
  const std::set<std::string> known(declared.begin(), declared.end());
  std::map<std::string, double> first_seen;
  for (const ObservationFile& file : files) {
    for (const Observation& observation : file.observations) {
      if (observation.object.empty() || known.contains(observation.object)) continue;
      double& stamp = first_seen.try_emplace(observation.object, observation.stamp_s).first->second;
      stamp = std::min(stamp, observation.stamp_s);
    }
  }
  std::vector<std::string> ids;
  ids.reserve(first_seen.size());
  for (const auto& [id, stamp] : first_seen) ids.push_back(id);
  std::stable_sort(ids.begin(), ids.end(), [&](const std::string& a, const std::string& b) {
    return first_seen.at(a) < first_seen.at(b);
  });
  return ids;
}

std::vector<double> stamps_of(const std::vector<ObservationFile>& files,
                              const CameraFiles& camera) {
  std::set<double> stamps;
  if (camera.odometry)
    for (const StampedPose& pose : camera.odometry->poses) stamps.insert(pose.stamp);
  // Stamps that differ by the rounding of files are one.
  const auto add = [&](double stamp) {
    const auto next = stamps.lower_bound(stamp - kSameStamp);
    if (next == stamps.end() || *next > stamp + kSameStamp) stamps.insert(stamp);
  };
  for (const PlacedStamp& one : camera.stamps) add(one.stamp);
  if (camera.images)
    for (const ImageList::Image& image : camera.images->images) add(image.at.stamp);
  std::set<double> seen;
  for (const ObservationFile& file : files)
    for (const Observation& observation : file.observations) seen.insert(observation.stamp_s);
  for (const double stamp : seen) add(stamp);
  return {stamps.begin(), stamps.end()};
}

Poses interpolated(const Timeline& timeline, const std::vector<StampedPose>& odometry) {
  std::vector<StampedPose> known;
  std::set<double> misses;
  for (const StampedPose& pose : odometry) {
    if (pose.pose) {
      known.push_back(pose);
    } else {
      misses.insert(pose.stamp);
    }
  }
  std::sort(known.begin(), known.end(),
            [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
  Poses poses;
  poses.reserve(timeline.size());
  for (const double stamp : timeline.stamps()) {
    const auto after =
        std::lower_bound(known.begin(), known.end(), stamp,
                         [](const StampedPose& pose, double s) { return pose.stamp < s; });
    poses.emplace_back();
    if (after == known.end() || misses.contains(stamp)) continue;
    if (after->stamp == stamp) {
      poses.back() = after->pose;
      continue;
    }
    if (after == known.begin()) continue;
    const StampedPose& before = *std::prev(after);
    const double gap = after->stamp - before.stamp;
    if (gap > kLongestGap) continue;
    const double part = (stamp - before.stamp) / gap;
    const SE3d motion = before.pose->inverse() * *after->pose;
    poses.back() = *before.pose * SE3d::exp(part * motion.log());
  }
  return poses;
}

void add_observations(const ObservedRecording& observed, const Timeline& timeline,
                      Sequence& sequence) {
  if (observed.files.empty()) return;
  sequence.observations.resize(timeline.size());
  std::map<std::string, ObjectRecording*> recordings;
  for (ObjectRecording& recording : sequence.objects) recordings[recording.id] = &recording;
  for (const ObservationFile& file : observed.files) {
    for (std::size_t i = 0; i < file.observations.size(); ++i) {
      const Observation& observation = file.observations[i];
      const auto frame = timeline.at_stamp(observation.stamp_s);
      if (!frame) {
        throw InvalidInput(
            fmt::format("{}: got an observation at stamp {} s, where {} has no frame",
                        file.place(i), observation.stamp_s, timeline.source()));
      }
      sequence.observations[*frame].push_back(observation);
      if (observation.object.empty()) continue;
      auto& best = recordings.at(observation.object)->detections[*frame];
      if (!best) best = from_body(observation, observed.cameras);
    }
  }
}

}  // namespace posemix::internal
