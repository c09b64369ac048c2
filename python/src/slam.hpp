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

/// Rows of seven numbers; of NaN for a miss.
MaybePoses maybe_poses(const Rows& rows, const std::string& name);
Array rows_of(const MaybePoses& poses);

/// What a run does after every frame, without the interpreter's lock held: signals are handed on,
/// and `progress` (None or a function of frames done and in all) is called.
std::function<bool(std::size_t, std::size_t)> progress_of(const nb::object& progress);

}  // namespace posemix::python
