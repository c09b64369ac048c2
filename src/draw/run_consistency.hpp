// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "posemix/slam/consistency.hpp"
#include "posemix/slam/job.hpp"
#include "posemix/slam/run.hpp"

namespace posemix::internal {

/// The consistency of T_camera_object over the frames that have both estimate and truth, along the
/// axes of the camera; empty where these are fewer than two, or a covariance is not positive
/// definite.
std::optional<ConsistencyReport> relative_consistency(const SlamJob& job, const SlamRun& run,
                                                      std::size_t object);

/// The same of T_world_camera, without the frames before the camera moved, at which its pose is
/// known exactly.
std::optional<ConsistencyReport> camera_consistency(const SlamJob& job, const SlamRun& run);

/// Where the verdict comes from: the axis with the most errors outside 3 sigma, as "16 % of
/// position x outside 3 sigma", where it has more than twice as many as it should; otherwise the
/// direction that is most at fault. Empty for a consistent pose.
std::string fault_text(const ConsistencyReport& report);

/// The mean NEES with its confidence interval: "mean NEES 1.22 (1 expected), 95 % interval 0.9 to
/// 1.7".
std::string nees_text(const NeesSummary& pose);

}  // namespace posemix::internal
