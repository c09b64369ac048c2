// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filter.hpp"
#include "posemix/slam/run.hpp"

namespace posemix::python {

using MaybePoses = std::vector<std::optional<SE3d>>;

/// Poses from rows of seven numbers; a row of NaN is a frame without a pose.
MaybePoses maybe_poses(const Rows& rows, const std::string& name);
Array rows_of(const MaybePoses& poses);

/// The callback of a run after every frame, called without the interpreter's lock: it handles
/// signals and calls `progress` (None, or a function of the number of frames done and in all).
std::function<bool(std::size_t, std::size_t)> progress_of(const nb::object& progress);

}  // namespace posemix::python
