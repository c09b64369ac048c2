// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "recording.hpp"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/gzip.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

/// A file of a folder, or the same with .gz after its name.
std::optional<fs::path> plain_or_gzip(const fs::path& folder, const std::string& name) {
  for (const std::string& candidate : {name, name + ".gz"}) {
    if (fs::is_regular_file(folder / candidate)) return folder / candidate;
  }
  return std::nullopt;
}

std::vector<StampedPose> read_fiducial_path(const FiducialRecording& recording,
                                            const std::string& name) {
  const std::optional<fs::path> path = plain_or_gzip(recording.folder, name);
  if (!path) return {};
  return parse_tum(read_file_or_gzip(*path), path->string());
}

}  // namespace

std::vector<FiducialRecording> find_fiducial_recordings(const fs::path& folder) {
  std::vector<FiducialRecording> recordings;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    if (fs::is_directory(path) && plain_or_gzip(path, "corners.csv") &&
        plain_or_gzip(path, "cameras.yaml"))
      recordings.push_back({path.filename().string(), path});
  }
  if (error) throw InvalidInput(fmt::format("{}: {}", folder.string(), error.message()));
  if (recordings.empty()) {
    throw InvalidInput(fmt::format(
        "{}: has no recording of tags, expected sub-folders with corners.csv and cameras.yaml",
        folder.string()));
  }
  std::sort(recordings.begin(), recordings.end(),
            [](const FiducialRecording& a, const FiducialRecording& b) { return a.name < b.name; });
  return recordings;
}

FiducialFolder read_fiducial_recording(const FiducialRecording& recording,
                                       std::optional<double> size_m) {
  const fs::path& folder = recording.folder;
  FiducialFolder result;
  result.cameras = read_cameras(folder / "cameras.yaml");
  if (const auto poses = plain_or_gzip(folder, "camera_poses.yaml"))
    read_camera_poses(*poses, result.cameras);
  if (const auto tags = plain_or_gzip(folder, "tagslam.yaml")) result.tags = read_tag_map(*tags);
  if (size_m) result.tags.default_size_m = size_m;
  result.odometry = odometry_of_rig(read_fiducial_path(recording, "odometry.tum"),
                                    result.tags.rig_odometry.value_or(SE3d()));
  const std::vector<CornerSighting> corners =
      read_corners(plain_or_gzip(folder, "corners.csv").value());
  result.fiducials = observe_fiducials(corners, result.cameras, result.tags);
  complete_rig(result);
  if (result.fiducials.observations.empty()) {
    throw InvalidInput(
        fmt::format("{}: has no observation of a tag of known size by a camera of known pose",
                    folder.string()));
  }
  return result;
}

ReferencePath read_fiducial_reference(const FiducialRecording& recording) {
  return ReferencePath(read_fiducial_path(recording, "reference_rig.tum"));
}

}  // namespace posemix
