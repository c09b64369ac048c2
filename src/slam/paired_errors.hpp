// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include "posemix/slam/evaluation.hpp"

/// Estimates beside detections.
namespace posemix::internal {

/// Medians of the errors of T_camera_object over the frames with an estimate, a detection and a
/// truth, which is the nearest of the equivalent ones.
PairedErrors paired_errors(const Sequence& sequence, const SlamRun& run, std::size_t object,
                           const ErrorReduction& reduction);

}  // namespace posemix::internal
