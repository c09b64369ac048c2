// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/noise_statistics.hpp"

/// Detections with their truth, from which the noise of a detector is learned.
namespace posemix {

/// A detection with its truth, T_camera_object both.
struct NoiseObservation {
  SE3d truth;
  SE3d detected;
  std::size_t recording = 0;  ///< observations of one recording belong together
  double stamp_s = std::numeric_limits<double>::quiet_NaN();  ///< NaN where it is not known
  /// Path of the viewing direction (view_angle) since the beginning of the track; where NaN, the
  /// path between the detections of the track is taken.
  double view_path_rad = std::numeric_limits<double>::quiet_NaN();
};

/// The detections of one object in one recording: an entry per frame in which the truth is known,
/// in the order of time, empty where the object was not detected.
using NoiseTrack = std::vector<std::optional<NoiseObservation>>;

/// The track of a recording with one truth and one detection per frame, T_camera_object both, and
/// the stamps of the frames [s], none where they are not known. Frames without a truth are left
/// out. The path of the viewing direction is summed over all others, also those without a
/// detection.
/// @throws InvalidInput when the numbers of frames differ, and for stamps that decrease
NoiseTrack noise_track(std::span<const std::optional<SE3d>> truth,
                       std::span<const std::optional<SE3d>> detected, std::size_t recording = 0,
                       std::span<const double> stamps_s = {});

/// Median over the tracks of the time between successive frames [s]; NaN without stamps.
double seconds_per_frame(std::span<const NoiseTrack> tracks);

/// All detections of the tracks, one track after the other.
std::vector<NoiseObservation> observations_of(std::span<const NoiseTrack> tracks);

/// The residual n of a detection Y [rad, m; for NoiseFrame::ray the translation as a fraction of
/// the range]: Y = T Exp(n) along the object's axes (midway-merge paper, eq. 32), or the same along
/// the camera's axes or the viewing ray, with the rotation about the object's origin in all. With
/// T = T_camera_object offset it is the n of a NoiseComponent.
Vector6d detection_residual(const SE3d& truth, const SE3d& detected, NoiseFrame frame);

/// The residuals by coordinate, with an entry per track and frame like the tracks: rotations in
/// degrees, translations in metres, or for NoiseFrame::ray as a fraction of the range.
std::array<std::vector<ResidualTrack>, 6> residual_tracks(std::span<const NoiseTrack> tracks,
                                                          NoiseFrame frame);

}  // namespace posemix
