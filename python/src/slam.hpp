// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "argument.hpp"
#include "filter.hpp"
#include "posemix/slam/run.hpp"
#include "seed.hpp"
#include "slam_settings.hpp"

namespace posemix::python {

/// A run with the times of its frames and the names of its objects.
struct RecordedRun : SlamRun {
  std::vector<double> stamps = {};
  std::vector<std::string> ids = {};
};

using Models = std::vector<ObjectModel>;

inline Models models_of(const Argument<Models>& given, const std::string& name) {
  return entries_of(given, name, "an ObjectModel");
}

inline ConcentratedSE3 unit_density() { return ConcentratedSE3(SE3d(), Matrix6d::Identity()); }

/// The callback of a run after every frame, called without the interpreter's lock: it handles
/// signals and calls `progress` (None, or a function of the number of frames done and in all).
std::function<bool(std::size_t, std::size_t)> progress_of(const nb::object& progress);

}  // namespace posemix::python
