// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posemix/detector/observation.hpp"
#include "posemix/fiducial/camera_file.hpp"
#include "posemix/fiducial/corner_file.hpp"
#include "posemix/fiducial/corner_noise.hpp"
#include "posemix/fiducial/tag_file.hpp"

/// From the corners of tags in a recording to observations.
namespace posemix {

/// Settings of observe_fiducials.
struct FiducialSettings {
  CornerOrder order = CornerOrder::apriltag;
  std::optional<CornerNoise> noise = {};  ///< of all cameras; learned from the corners if not given
  /// Sightings with a pose that a camera needs for a noise of its own. Those of all cameras
  /// together are used for a camera with fewer, and if they are fewer too, `assumed`.
  std::size_t least_sightings = 50;
  CornerNoise assumed = {.sd_px = 0.5, .dof = 4.0};
  double least_weight = 1e-6;  ///< components with less are left out
  /// Standard deviation of an error that all corners of a sighting share [px], over the focal
  /// length an angle (add_bearing_error). It is not learned: of one camera's corners nothing shows
  /// it.
  double bearing_sd_px = 0.3;
  std::string detector = {};  ///< name of the detector in the observations
};

/// Where the noise of a camera's corners is from.
enum class CornerNoiseSource {
  own,      ///< learned from the sightings of the camera
  all,      ///< learned from those of all cameras
  given,    ///< FiducialSettings::noise
  assumed,  ///< FiducialSettings::assumed
};

/// The words of CornerNoiseSource in files.
template <>
inline constexpr WordTable<CornerNoiseSource, 4> words<CornerNoiseSource>{{
    {"own", CornerNoiseSource::own},
    {"all", CornerNoiseSource::all},
    {"given", CornerNoiseSource::given},
    {"assumed", CornerNoiseSource::assumed},
}};

/// The noise of one camera's corners.
struct CameraCornerNoise {
  std::string camera = {};
  CornerNoise noise = {};
  std::size_t sightings = 0;  ///< of the camera, with a pose
  CornerNoiseSource source = CornerNoiseSource::own;
};

/// The observations of a recording, and what became of its sightings.
struct Fiducials {
  std::vector<Observation> observations =
      {};  ///< in the order of the sightings; the id is the tag's
  std::vector<CameraCornerNoise> noise = {};  ///< of every camera
  std::size_t sightings = 0;                  ///< all, the next three included
  std::size_t ignored = 0;                    ///< of tags that are to be ignored
  std::size_t without_size = 0;               ///< of tags of unknown size
  std::size_t without_pose = 0;               ///< whose corners are no image of a tag's front
  /// What is hardly true: noise of corners, sizes of tags, order of corners, intrinsics; one
  /// sentence each.
  std::vector<std::string> warnings = {};
};

/// Weight of the leading component below which an observation counts as ambiguous.
inline constexpr double kAmbiguousBelow = 0.95;

/// Number of observations whose leading component has a weight below kAmbiguousBelow.
std::size_t ambiguous_count(std::span<const Observation> observations);

/// The minima of every sighting, the noise of the corners per camera, and the observations that
/// follow: equation by equation as tag_minima, fit_corner_noise and tag_components.
/// @throws InvalidInput for a sighting of an unknown camera, naming its place and topic;
/// when no camera or no sighting is given; as tag_minima and tag_components
Fiducials observe_fiducials(std::span<const CornerSighting> sightings,
                            std::span<const RigCamera> cameras, const TagMap& tags,
                            const FiducialSettings& settings = {});

/// The tables of a folder of fiducials.
///
/// `cameras.csv`: camera, T_rig_camera, covariance of n of T_rig_camera Exp(n); empty where it is
/// not stated. `corner_noise.csv`: camera, sd_px, dof, sightings, source. `tag_priors.csv`: id,
/// size_m, T_map_tag, covariance of n of T_map_tag Exp(n). The columns of poses and covariances are
/// those of observations.
std::string format_rig(std::span<const RigCamera> cameras);
std::string format_corner_noise(std::span<const CameraCornerNoise> noise);
std::string format_tag_priors(const TagMap& tags);

}  // namespace posemix
