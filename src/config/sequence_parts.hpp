// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/config/detector_noise.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/bop.hpp"
#include "posemix/io/dataset.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/tum.hpp"

/// The parts of a sequence file, one source file each.
namespace posemix::internal {

using Poses = std::vector<std::optional<SE3d>>;

/// Ranges that keep every later computation finite; what lies beyond is in a wrong unit.
inline constexpr NumberRange kSd{.lowest = 1e-9, .highest = 1e6};
inline constexpr NumberRange kSdOrZero{.lowest = 0, .highest = 1e6};
inline constexpr NumberRange kPosition{.lowest = -kFarthestPosition, .highest = kFarthestPosition};
inline constexpr NumberRange kPeriod{.lowest = 1e-6, .highest = 1e6};
inline constexpr double kLatestStamp = 1e12;

/// Finds the files that a document names.
class FileFinder {
 public:
  FileFinder(std::vector<std::filesystem::path> folders, std::vector<std::string> roots)
      : folders_(std::move(folders)), roots_(std::move(roots)) {}

  /// The file or folder named under a key. Throws InvalidInput with the places looked at.
  std::filesystem::path find(const TomlTable& table, std::string_view key) const;

  /// The scene that a table names by `bop_dataset`, `split` and `scene`, or by `ycb_video` and
  /// `sequence`; read once.
  const DatasetScene& scene(const TomlTable& table) const;

 private:
  std::vector<std::filesystem::path> folders_;
  std::vector<std::string> roots_;
  std::shared_ptr<std::map<std::string, DatasetScene>> scenes_ =
      std::make_shared<std::map<std::string, DatasetScene>>();
};

/// Runs `action`; an InvalidInput that it throws gets the place of the key before its message.
template <typename Action>
auto located(const TomlTable& table, std::string_view key, Action&& action) {
  try {
    return action();
  } catch (const InvalidInput& error) {
    throw InvalidInput(table.location(key) + ": " + error.what());
  }
}

/// Poses of a file, in the order of its stamps.
struct StampedFile {
  std::string name;
  std::vector<StampedPose> poses;
};

/// Reads the TUM file named under a key; stamps and positions out of range are errors.
StampedFile read_stamped(const TomlTable& table, std::string_view key, const FileFinder& files,
                         const TumOptions& options = {});

/// The frames of a sequence.
class Timeline {
 public:
  /// Stamps in seconds, increasing; `source` names the file that they are from.
  Timeline(std::vector<double> stamps, std::string source);
  /// Frames that are known by number only, counted from zero, with `period_s` between two numbers.
  Timeline(std::vector<std::int64_t> numbers, double period_s, std::string source);

  const std::vector<double>& stamps() const { return stamps_; }
  std::size_t size() const { return stamps_.size(); }
  const std::string& source() const { return source_; }
  /// The frame whose stamp is nearest, where it is within half the least distance of stamps and 1
  /// ms.
  std::optional<std::size_t> at_stamp(double stamp) const;
  /// The frame of a number counted from zero.
  std::optional<std::size_t> at_number(std::int64_t number) const;

  /// The poses of a file at the frames; records at other times are left out. Throws InvalidInput
  /// when none is left.
  Poses select(const StampedFile& file) const;

 private:
  std::vector<double> stamps_;
  std::optional<std::vector<std::int64_t>> numbers_;
  double tolerance_;
  std::string source_;
};

// --- [camera] and [motion]

/// The table's key `first_frame`, the number of the first frame. Throws where `least`, the least
/// number in the file `name`, is below it.
std::int64_t read_first_frame(const TomlTable& table, const std::string& name, std::int64_t least);

/// Camera poses of a dataset's scene, by number counted from zero; empty: not known.
struct NumberedScene {
  std::string name;
  std::map<std::int64_t, std::optional<SE3d>> poses;
};

struct CameraFiles {
  std::optional<StampedFile> odometry;
  std::optional<StampedFile> truth;          ///< lever arm applied
  std::optional<NumberedScene> scene_truth;  ///< in place of that
  double frame_period_s = kFramePeriodS;
};

CameraFiles read_camera_files(const TomlTable& root, const FileFinder& files);
PoseDensity read_camera_prior(const TomlTable& root, const Poses& camera_truth);
MotionSettings read_motion(const TomlTable& root, bool has_odometry);

// --- [noise] and standard deviations

/// A number or an array of three under the key, with its unit's factor applied.
Eigen::Vector3d read_sd(const TomlTable& table, std::string_view key, const NumberRange& range,
                        double unit);
/// Seven numbers tx ty tz qx qy qz qw.
SE3d read_pose(const TomlTable& table, std::string_view key);

std::map<std::string, DetectorNoise> read_noise_models(const TomlTable& root);

// --- [[objects]]

/// The detections of one object before they are put on the frames: by stamp, or by number counted
/// from zero.
struct DetectionFile {
  std::string name;
  std::optional<std::vector<StampedPose>> stamped;
  std::map<std::int64_t, SE3d> numbered;

  Poses on(const Timeline& timeline) const;
};

/// The key `detections`; empty for an object with the key `class`, which has candidates instead.
std::optional<DetectionFile> read_detections(const TomlTable& object, const FileFinder& files);

/// Detections of one class, by number counted from zero.
struct CandidateFile {
  std::string name;
  std::string class_id;
  std::map<std::int64_t, std::vector<ScoredPose>> numbered;
};
/// The key `candidates`: detections that name a class; none where it is missing.
std::vector<CandidateFile> read_candidates(const TomlTable& root, const FileFinder& files);
/// Fills relative_truth and world_truth from the key `ground_truth`.
void read_object_truth(const TomlTable& object, const FileFinder& files, const Timeline& timeline,
                       ObjectRecording& recording);

/// Frames, camera and objects, which have those ids.
Sequence read_recordings(const TomlTable& root, const FileFinder& files, const CameraFiles& camera,
                         const std::vector<std::string>& ids);

/// The key `symmetries`; the trivial group without it.
SymmetryGroup read_object_symmetries(const TomlTable& object, const FileFinder& files);

// --- [filter]

/// The keys of the multi-object filter; those that are missing stay as they are in `settings`.
MultiObjectSettings read_multi_object(const TomlTable& filter, MultiObjectSettings settings);
/// Reads the table `association` into the settings, where there is one.
void read_association(const TomlTable& root, MultiObjectSlamSettings& settings);
/// The method of the table `filter` with the settings that it changes.
SlamMethod read_filter(const TomlTable& root);

}  // namespace posemix::internal
