// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posemix/filter/moving_object_smoother.hpp"
#include "posemix/slam/smoothing.hpp"

/// Smoothing of recordings in which objects move (docs/moving-objects.md, "Joined with object
/// SLAM").
namespace posemix::internal {

/// A run of the filter with what smoothers of single objects need of it, by frame.
struct FilteredRun {
  std::vector<FrameEstimate> frames;
  std::vector<std::vector<ObservedObject>> observed;
  std::vector<std::vector<KnownFrame>> known_frames;  ///< that may hold objects
};

FilteredRun filtered_run(const Sequence& sequence, const PoseDensity& camera_prior,
                         const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
                         const RunOptions& options);

/// One object at every frame given all of them, before cameras whose poses are exact; none before
/// its first observation. `cameras` are T_world_body.
using SmoothedTrack = std::vector<std::optional<MovingObjectEstimate>>;
SmoothedTrack smoothed_track(const FilteredRun& run, std::size_t object, const ObjectModel& model,
                             const MovingObjectSettings& settings, const std::vector<SE3d>& cameras,
                             const std::vector<double>& stamps);

/// The part of a recording that stands still: static objects, and objects that are put down
/// elsewhere as one static object for every place.
struct StaticPart {
  Sequence sequence;
  std::vector<ObjectModel> models = {};
  /// By object and frame, the index of the static object; none where it moves or was not seen so
  /// far.
  std::vector<std::vector<std::optional<std::size_t>>> object_at = {};
};

/// Of the first frames. `tracks` are those of objects that are put down elsewhere; the others are
/// not looked at.
StaticPart static_part(const Sequence& sequence, std::size_t frames,
                       const std::vector<ObjectModel>& models,
                       const std::vector<SmoothedTrack>& tracks);

/// run_smoothed where objects move.
SlamRun smooth_with_moving(const Sequence& sequence, const PoseDensity& camera_prior,
                           const std::vector<ObjectModel>& models,
                           const ObjectSlamSettings& settings, const SmoothingSettings& smoothing,
                           const RunOptions& options);

}  // namespace posemix::internal
