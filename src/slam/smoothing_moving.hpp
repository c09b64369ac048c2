// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posemix/filter/moving_object_smoother.hpp"
#include "posemix/slam/smoothing.hpp"

/// Smoothing of recordings that the filter has to run over first: objects move
/// (docs/moving-objects.md, "Joined with object SLAM"), or detections name classes
/// (docs/filter.md).
namespace posemix::internal {

/// A run of the filter with what smoothers of single objects need of it, by frame.
struct FilteredRun {
  std::vector<FrameEstimate> frames;
  Sequence named = {};  ///< its recording by named_recording
  std::vector<std::vector<ObservedObject>> observed;
  std::vector<std::vector<KnownFrame>> known_frames;  ///< that may hold objects
  std::vector<bool> camera_lasts;  ///< whether the camera's error is that of its neighbours, too
};

/// Whether detections name classes.
bool has_detections_of_classes(const Sequence& sequence);

/// The frames of a recording that the filter has run over, without truth, and with detections of
/// classes under the ids of the objects that the filter took them for; those of none are left out,
/// and so are those of objects that it does not have in the end, or that another has taken the
/// place of.
Sequence named_recording(Sequence sequence, const std::vector<ObjectModel>& models,
                         const std::vector<FrameEstimate>& frames);

FilteredRun filtered_run(const Sequence& sequence, const PoseDensity& camera_prior,
                         const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
                         const RunOptions& options);

/// The error of the camera's pose at a frame in two parts, and how the first changes.
struct CameraError {
  Matrix6d lasting = Matrix6d::Zero();   ///< that of the frames before and after, too
  Matrix6d of_image = Matrix6d::Zero();  ///< of this image alone
  Matrix6d change = Matrix6d::Zero();    ///< of the lasting part since the frame before
};

/// A smoothed joint density of camera and static objects.
struct JointSmoothing {
  SlamRun run;
  std::vector<Matrix6d> camera_lags;  ///< FixedLagSmoother::camera_lags
};

/// run_smoothed for objects that are static and detected by their names.
JointSmoothing smooth_joint(const Sequence& sequence, const PoseDensity& camera_prior,
                            const std::vector<ObjectModel>& models,
                            const ObjectSlamSettings& settings, const SmoothingSettings& smoothing,
                            const RunOptions& options);

/// One object at every frame given all of them, before cameras with these errors; none before its
/// first observation. The part of the errors that lasts is not in the estimates.
using SmoothedTrack = std::vector<std::optional<MovingObjectEstimate>>;
SmoothedTrack smoothed_track(const FilteredRun& run, std::size_t object, const ObjectModel& model,
                             const MovingObjectSettings& settings,
                             const std::vector<FrameEstimate>& frames,
                             const std::vector<CameraError>& errors);

/// The part of a recording that stands still: static objects, and objects that are put down
/// elsewhere as one static object for every place.
struct StaticPart {
  Sequence sequence;
  std::vector<ObjectModel> models = {};
  /// By object and frame, the index of the static object; none where it moves or was not seen so
  /// far.
  std::vector<std::vector<std::optional<std::size_t>>> object_at = {};
};

/// `tracks` are those of objects that are put down elsewhere; the others are not looked at.
StaticPart static_part(const Sequence& sequence, const std::vector<ObjectModel>& models,
                       const std::vector<SmoothedTrack>& tracks);

/// run_smoothed where the filter has to run first.
SlamRun smooth_after_filter(const Sequence& sequence, const PoseDensity& camera_prior,
                            const std::vector<ObjectModel>& models,
                            const ObjectSlamSettings& settings, const SmoothingSettings& smoothing,
                            const RunOptions& options);

}  // namespace posemix::internal
