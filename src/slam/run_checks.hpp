// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/slam/evaluation.hpp"
#include "posemix/slam/job.hpp"
#include "posemix/slam/run.hpp"
#include "posemix/slam/sequence.hpp"

/// Checks of what belongs to each other.
namespace posemix::internal {

/// @throws InvalidInput as validate, when the run has no frame, more of them than the sequence, or
/// a frame without an entry for every object
void require_fit(const Sequence& sequence, const SlamRun& run);

/// @throws InvalidInput as above, and unless there is a model of every object
void require_fit(const SlamJob& job, const SlamRun& run);

/// @throws InvalidInput unless there are metrics of every model
void require_fit(const SlamJob& job, const Metrics& metrics);

}  // namespace posemix::internal
