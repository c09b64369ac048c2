// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "io/json_numbers.hpp"
#include "posemix/slam/job.hpp"
#include "posemix/slam/run.hpp"

namespace posemix::internal {

/// The keys `camera_verdict` and `relative_verdicts` of the table `consistency` in metrics.json:
/// what program, picture and report say of every pose. null where there is too little ground truth.
Json verdicts_json(const SlamJob& job, const SlamRun& run);

}  // namespace posemix::internal
