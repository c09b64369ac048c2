// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include "method.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix {

/// A run and what it was made of.
struct FinishedRun {
  const SlamJob& job;
  const SlamRun& run;
  const Metrics& metrics;
};

/// Writes the results of a run and their page into a folder of their own below that of the study,
/// and returns the path of the page from there.
/// @throws OutputError where they cannot be written
std::string keep_run(const YcbvStudySettings& settings, const Recording& recording,
                     const YcbvMethod& method, const FinishedRun& finished);

}  // namespace posemix
