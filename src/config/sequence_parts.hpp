// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/observation_numbers.hpp"
#include "posemix/config/detector_noise.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/bop.hpp"
#include "posemix/io/bop_views.hpp"
#include "posemix/io/dataset.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/tum.hpp"

/// The parts of a sequence file, one source file each.
namespace posemix::internal {

using Poses = std::vector<std::optional<SE3d>>;

/// Ranges that keep all later computations finite; a value outside must be in a wrong unit.
inline constexpr NumberRange kSd{.lowest = 1e-9, .highest = 1e6};
inline constexpr NumberRange kSdOrZero{.lowest = 0, .highest = 1e6};
inline constexpr NumberRange kPosition{.lowest = -kFarthestPosition, .highest = kFarthestPosition};
inline constexpr NumberRange kPeriod{.lowest = 1e-6, .highest = 1e6};

/// Finds the files that a document names.
class FileFinder {
 public:
  FileFinder(std::vector<std::filesystem::path> folders, std::vector<std::string> roots)
      : folders_(std::move(folders)), roots_(std::move(roots)) {}

  /// The file or folder named under a key.
  /// @throws InvalidInput with the places that were searched
  std::filesystem::path find(const TomlTable& table, std::string_view key) const;

  /// The scene that a table names by `bop_dataset`, `split` and `scene`, or by `ycb_video` and
  /// `sequence`. Every scene is read only once.
  const DatasetScene& scene(const TomlTable& table) const;

 private:
  std::vector<std::filesystem::path> folders_;
  std::vector<std::string> roots_;
  std::shared_ptr<std::map<std::string, DatasetScene>> scenes_ =
      std::make_shared<std::map<std::string, DatasetScene>>();
};

/// Runs `action`; an InvalidInput that it throws gets the location of the key before its message,
/// unless it begins with a line of the same document.
template <typename Action>
auto located(const TomlTable& table, std::string_view key, Action&& action) {
  try {
    return action();
  } catch (const InvalidInput& error) {
    const std::string location = table.location(key);
    const std::string document = location.substr(0, location.rfind(':') + 1);
    if (std::string_view(error.what()).starts_with(document)) throw;
    throw InvalidInput(location + ": " + error.what());
  }
}

/// The poses of a file, in the order of their stamps.
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
  /// Frames with stamps in seconds, increasing; `source` is the name of the file that has them.
  Timeline(std::vector<double> stamps, std::string source);
  /// Frames known only by their numbers, counted from zero; `period_s` is the time from one number
  /// to the next.
  Timeline(std::vector<std::int64_t> numbers, double period_s, std::string source);

  const std::vector<double>& stamps() const { return stamps_; }
  std::size_t size() const { return stamps_.size(); }
  const std::string& source() const { return source_; }
  /// The frame with the nearest stamp, if that is within 1 ms and half of the least distance
  /// between stamps.
  std::optional<std::size_t> at_stamp(double stamp) const;
  /// The frame with a number, counted from zero.
  std::optional<std::size_t> at_number(std::int64_t number) const;
  /// The frame of a detection with a number.
  /// @throws InvalidInput with the name of its file, where there is none
  std::size_t frame_of(std::int64_t number, const std::string& file) const;

  /// The poses of a file at the frames; poses at other times are left out.
  /// @throws InvalidInput when none is left
  Poses select(const StampedFile& file) const;

 private:
  std::vector<double> stamps_;
  std::optional<std::vector<std::int64_t>> numbers_;
  double tolerance_;
  std::string source_;
};

// --- [camera] and [motion]

/// The key `first_frame` of a table, the number of the first frame.
/// @throws InvalidInput when it is above `least`, the least number in the file `name`
std::int64_t read_first_frame(const TomlTable& table, const std::string& name, std::int64_t least);

/// Camera poses of a dataset's scene by number, counted from zero; empty if not known.
struct NumberedScene {
  std::string name;
  std::map<std::int64_t, std::optional<SE3d>> poses;
};

/// A stamp in a list, and where it stands, for messages.
struct PlacedStamp {
  double stamp;
  std::string place;
};

/// The images that the detectors have searched.
struct ImageList {
  struct Image {
    PlacedStamp at;
    std::string camera;
  };
  bool all = false;  ///< every frame is an image of every camera
  std::vector<Image> images = {};

  /// Names of cameras by frame.
  /// @throws InvalidInput for a stamp without a frame, and a camera that there is not
  std::vector<std::vector<std::string>> on(const Timeline& timeline,
                                           const std::vector<BodyCamera>& cameras) const;
  /// @throws InvalidInput for a detector that no object names, where all objects name theirs
  void require_known_detectors(const std::vector<BodyCamera>& cameras,
                               const std::vector<ObjectModel>& models) const;
};

struct CameraFiles {
  std::optional<StampedFile> odometry;
  std::optional<StampedFile> truth;          ///< with the lever arm applied
  std::optional<NumberedScene> scene_truth;  ///< used instead of `truth` for a dataset
  double frame_period_s = kFramePeriodS;
  /// Of frames, in a recording with observations.
  std::vector<PlacedStamp> stamps = {};
  std::optional<ImageList> images = {};
};

CameraFiles read_camera_files(const TomlTable& root, const FileFinder& files);
PoseDensity read_camera_prior(const TomlTable& root, const Poses& camera_truth);
/// Whether the first pose is unknown (`start.pose = "unknown"`).
bool starts_anywhere(const TomlTable& root);
/// The prior of a camera that may be anywhere near objects whose pose is known.
PoseDensity prior_anywhere(const TomlTable& root, const std::vector<ObjectModel>& models);
MotionSettings read_motion(const TomlTable& root, bool has_odometry);

// --- [noise] and standard deviations

/// A number or an array of three numbers under the key, multiplied by `unit`.
Eigen::Vector3d read_sd(const TomlTable& table, std::string_view key, const NumberRange& range,
                        double unit);
/// A pose from seven numbers tx ty tz qx qy qz qw.
SE3d read_pose(const TomlTable& table, std::string_view key);

/// The tables `[noise.NAME]`, as they are stated.
std::map<std::string, DetectorNoise> read_noise_models(const TomlTable& root);

/// Puts what the multi-object filter assumes where keys are missing into the models that are
/// `used`, with a warning for each.
void assume_missing(const TomlTable& root, const std::set<std::string>& used,
                    double default_clutter, std::map<std::string, DetectorNoise>& models);

// --- [[observations]] and [[cameras]]

/// Stamps of observations and odometry that differ by no more are one frame [s].
inline constexpr double kSameStamp = 1e-6;

/// The observations of one file.
struct ObservationFile {
  std::string name;
  std::vector<Observation> observations;
  std::vector<std::size_t> lines = {};  ///< in which they begin
  /// Keys of the sequence file that stand in place of the names in the file; empty: none.
  std::string camera_key = {};
  std::string detector_key = {};

  std::string place(std::size_t i) const { return fmt::format("{}:{}", name, lines[i]); }
};
/// All that is known from observations.
struct ObservedRecording {
  std::vector<ObservationFile> files;
  std::vector<BodyCamera> cameras;
};
/// Reads the key `observations`; empty if it is missing.
std::vector<ObservationFile> read_observation_files(const TomlTable& root, const FileFinder& files);
/// Reads the key `cameras`; empty if it is missing.
std::vector<BodyCamera> read_body_cameras(const TomlTable& root);
/// The objects and classes that observations name must be there; any id will do on sight.
void require_known_objects(const std::vector<ObservationFile>& files,
                           const std::vector<ObjectModel>& models, bool any_id);
/// The cameras and the detectors that observations name must be there.
void require_known_sources(const ObservedRecording& observed,
                           const std::vector<ObjectModel>& models);
/// Stamps on another clock, or in another unit, would be a long motion that nobody knows.
void require_one_clock(const ObservedRecording& observed, const CameraFiles& camera);
/// Whether an id can be a part of the names of files, and how it must be.
bool is_usable_id(const std::string& id);
inline constexpr std::string_view kUsableId = "1 to 100 letters, digits, '_', '.' and '-'";
/// The ids in the files that are not declared, in the order in which they are seen.
std::vector<std::string> ids_on_sight(const std::vector<ObservationFile>& files,
                                      const std::vector<std::string>& declared);
/// The stamps of images, odometry and observations.
std::vector<double> stamps_of(const std::vector<ObservationFile>& files, const CameraFiles& camera);
/// Odometry at the frames; between two of its poses a part of the motion between them. Where the
/// odometry has a line without a pose there is none.
Poses interpolated(const Timeline& timeline, const std::vector<StampedPose>& odometry);
/// Puts the observations into the frames of a sequence, and their best components, as they are from
/// the body, into the recordings of its objects.
void add_observations(const ObservedRecording& observed, const Timeline& timeline,
                      Sequence& sequence);

// --- [[frames]] and motion of objects

/// A frame with a known pose, before its poses are assigned to the frames of the recording.
struct FrameFile {
  std::string name;
  StampedFile file;
  /// Of the error of its pose about its origin, along the world's axes.
  Matrix6d covariance;

  FrameRecording on(const Timeline& timeline) const;
};
/// Reads the key `frames`; empty if it is missing.
std::vector<FrameFile> read_known_frames(const TomlTable& root, const FileFinder& files);
/// Reads the key `motion` of an object; static without it. `frames` are those that may hold it.
MotionModels read_object_motion(const TomlTable& object, const std::vector<FrameFile>& frames);

/// Objects that move are for the multi-object filter, smoothed as a whole or not, and have one
/// detector.
void check_motion(const TomlTable& object, const ObjectModel& model, const SlamJob& job,
                  const SlamMethod& method);

// --- [[objects]]

/// The noise model that a table names under a key; without the key, or by the name `default`, it is
/// default_detector_noise() unless there is a table of that name.
DetectorNoise noise_of(const TomlTable& object,
                       const std::map<std::string, DetectorNoise>& noise_models,
                       const std::string& key);
/// Adds the names of the noise models that a table of objects uses.
void add_used_noise(const TomlTable& object, std::set<std::string>& used);
/// The models of the tables [[objects]].
std::vector<ObjectModel> read_object_models(
    const std::vector<TomlTable>& tables, const FileFinder& files,
    const std::map<std::string, DetectorNoise>& noise_models, const std::vector<FrameFile>& frames);
/// The model of the table [on_sight], without an id.
ObjectModel read_model_on_sight(const TomlTable& table, const FileFinder& files,
                                const std::map<std::string, DetectorNoise>& noise_models,
                                const std::vector<FrameFile>& frames);

/// The detections of one object before they are assigned to frames: by stamp, or by number counted
/// from zero.
struct DetectionFile {
  std::string name;
  std::optional<std::vector<StampedPose>> stamped;
  std::map<std::int64_t, SE3d> numbered;
  /// All rows of a sighting, where they are read as mixtures; the poses are then those of the
  /// highest score.
  std::map<std::int64_t, Observation> mixtures = {};

  Poses on(const Timeline& timeline) const;
};

/// Reads the key `detections`; empty for an object with the key `class`, which has candidates
/// instead, and in a recording with observations.
std::optional<DetectionFile> read_detections(const TomlTable& object, const FileFinder& files,
                                             bool has_observations);

/// The detections of one class by number, counted from zero.
struct CandidateFile {
  std::string name;
  std::string class_id;
  std::map<std::int64_t, std::vector<ScoredPose>> numbered;
  /// In place of `numbered`, where rows are read as mixtures.
  std::map<std::int64_t, std::vector<Observation>> mixtures = {};

  std::set<std::int64_t> numbers() const;
};
/// Reads the rows of a BOP result file as `detections` or as `candidates`.
DetectionFile read_bop_detections(const TomlTable& table, const FileFinder& files);
CandidateFile read_bop_candidates(const TomlTable& table, const FileFinder& files);
/// Reads the key `candidates`, detections that name a class; empty if it is missing.
std::vector<CandidateFile> read_candidates(const TomlTable& root, const FileFinder& files);
/// Fills relative_truth and world_truth from the key `ground_truth`.
void read_object_truth(const TomlTable& object, const FileFinder& files, const Timeline& timeline,
                       ObjectRecording& recording);

/// Reads the frames and the recordings of the camera and of the objects with these ids; those that
/// are declared come first. The observations were read before.
Sequence read_recordings(const TomlTable& root, const FileFinder& files, const CameraFiles& camera,
                         const std::vector<std::string>& ids, const ObservedRecording& observed,
                         const std::vector<FrameFile>& frames);

/// Reads the key `symmetries`; without it the trivial group.
SymmetryGroup read_object_symmetries(const TomlTable& object, const FileFinder& files);

// --- [filter]

/// Reads the keys of the multi-object filter; without a key its value in `settings` is kept.
MultiObjectSettings read_multi_object(const TomlTable& filter, MultiObjectSettings settings);
/// Reads the table `moving` of the multi-object filter.
MovingObjectSettings read_moving_objects(const TomlTable& filter);
/// Read the tables `existence` and `health` of the multi-object filter.
ExistenceSettings read_existence(const TomlTable& filter);
HealthSettings read_health(const TomlTable& filter);
/// Reads the table `association` into the settings, if there is one.
void read_association(const TomlTable& root, MultiObjectSlamSettings& settings);
/// The method in the table `filter`, with the settings that the table changes.
SlamMethod read_filter(const TomlTable& root);

}  // namespace posemix::internal
