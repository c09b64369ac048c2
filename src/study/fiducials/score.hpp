// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posemix/detector/observation.hpp"
#include "posemix/fiducial/camera_file.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/slam/run.hpp"

/// Scores of SLAM on square tags against a reference path T_map_rig, as bench/python's
/// fiducials_score.py defines them.
namespace posemix {

/// A rotation that differs by more from the reference's is a wrong mode [deg].
inline constexpr double kWrongModeDeg = 15.0;
/// Views of a tag whose directions differ by more are from more than one side [deg].
inline constexpr double kSeveralSidesDeg = 20.0;

/// T_map_rig over time.
class ReferencePath {
 public:
  /// Poses by increasing stamps; frames without a pose are left out.
  explicit ReferencePath(std::span<const StampedPose> poses = {});

  /// The pose at a time, interpolated; nothing outside of the path and between stamps that are
  /// further apart than the gap. Translations are linear, rotations at a constant rate.
  std::optional<SE3d> at(double stamp_s, double longest_gap_s = 0.2) const;

 private:
  std::vector<double> stamps_;
  std::vector<SE3d> poses_;
};

/// Distances of a path to the reference.
struct PathScore {
  double rms_m = 0.0, median_m = 0.0, p95_m = 0.0, max_m = 0.0;
  SE3d alignment = {};                   ///< T_map_world
  std::vector<double> stamps_s = {};     ///< of path and reference
  std::vector<double> distances_m = {};  ///< at these stamps
};

/// Whether a path is moved to the reference before it is compared.
enum class PathAlignment {
  none,  ///< its frame is that of the reference
  rigid  ///< by the motion without scale that makes the distances least (Umeyama, 1991)
};

/// Compares positions at the stamps of the path; nothing where less than three have a reference.
std::optional<PathScore> score_path(std::span<const StampedPose> path,
                                    const ReferencePath& reference, PathAlignment alignment);

/// What the reference path says of one tag.
struct ReferenceTag {
  SE3d pose = {};             ///< T_map_tag
  std::size_t sightings = 0;  ///< at stamps with a reference
  double share = 0.0;         ///< of the sightings that have a component near the pose
  /// That of the best pose more than twice as far away; where it is as large as `share`, the
  /// choice depends on the spread alone.
  double rival_share = 0.0;
  double span_deg = 0.0;  ///< largest angle between two views of the tag
};

/// T_rig_camera by name.
using CameraPoses = std::map<std::string, SE3d>;
using ReferenceTags = std::map<std::string, ReferenceTag>;

/// The stated poses of cameras.
CameraPoses camera_poses(std::span<const RigCamera> cameras);

/// The poses of the tags that most sightings have a component near, all components of all sightings
/// put into the map by the reference path; weights do not count. Sightings of cameras without a
/// pose, and at stamps without a reference, are left out.
ReferenceTags reference_tags(std::span<const Observation> observations, const CameraPoses& cameras,
                             const ReferencePath& reference);

/// A tag as it is seen from a camera, of a detector or of an estimate.
struct TagSighting {
  double stamp_s = 0.0;
  std::string camera = {};
  std::string tag = {};
  SE3d pose = {};  ///< T_camera_tag
};

/// The best components of observations.
std::vector<TagSighting> best_sightings(std::span<const Observation> observations);

/// Sightings of a run: T_camera_tag of every tag that was seen in a frame, as the estimate stood
/// after it. A sighting of a tag without an estimate has none.
std::vector<TagSighting> estimated_sightings(const Sequence& sequence, const SlamRun& run,
                                             const CameraPoses& cameras);

/// Sightings that are turned by more than kWrongModeDeg against the reference.
struct ModeScore {
  struct Tag {
    std::size_t sightings = 0, wrong = 0;
    double last_s = 0.0;
    bool wrong_at_last = false;
  };
  std::size_t sightings = 0, wrong = 0;
  std::size_t frames = 0, wrong_frames = 0;  ///< with at least one sighting, and one that is wrong
  std::map<std::string, Tag> tags = {};
};

/// The reference is that of the rig at the stamp, the mounting of the camera and the reference pose
/// of the tag; sightings without one are left out.
ModeScore score_modes(std::span<const TagSighting> sightings, const CameraPoses& cameras,
                      const ReferenceTags& tags, const ReferencePath& reference);

/// The angle between two rotations [deg].
double angle_between_deg(const SE3d& a, const SE3d& b);
bool is_finite(const SE3d& pose);
/// Whether a rotation differs by more than kWrongModeDeg, or the pose is not finite.
bool is_wrong_mode(const SE3d& pose, const SE3d& reference);
/// The angle between the normals of two tags [deg].
double normal_angle_deg(const SE3d& a, const SE3d& b);

}  // namespace posemix
