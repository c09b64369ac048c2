// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/slam/job.hpp"

namespace posemix::internal {

/// Refuses a run whose numbers no reader of its results would take: where numbers of the input are
/// so large, or so little is known, that double precision holds nothing of a pose. evaluate() has
/// no use for such a run either.
/// @throws InvalidInput naming the first stamp and the pose
void require_readable(const SlamJob& job, const SlamRun& run);

}  // namespace posemix::internal
