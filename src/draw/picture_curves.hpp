// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posemix/draw/picture.hpp"

namespace posemix::internal {

/// One number per frame; empty for a frame without a value.
using Curve = std::vector<std::optional<double>>;

/// An error of a pose over time. The errors are empty without ground truth.
struct ErrorCurves {
  Curve estimate;
  Curve detector;
  Curve width;  ///< the norm that 99.7 % of consistent errors are below
};

/// What the strips of a pose show.
struct PoseCurves {
  ErrorCurves rotation;    ///< [deg]
  ErrorCurves position;    ///< [mm]
  Curve mode_probability;  ///< that the estimate is on the right mode; empty where no filter says
};

/// Of T_camera_object, against the nearest of the equivalent truths.
PoseCurves object_curves(const SlamJob& job, const SlamRun& run, std::size_t object);

/// Of T_world_camera.
PoseCurves camera_curves(const SlamJob& job, const SlamRun& run);

/// Whether any frame has a value.
bool has_values(const Curve& curve);

}  // namespace posemix::internal
