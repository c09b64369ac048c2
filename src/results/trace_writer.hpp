// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include "posemix/io/output_folder.hpp"
#include "posemix/slam/job.hpp"

namespace posemix::internal {

class HypothesisTexts;
class JsonWriter;

/// Digits of the id of a run: the first ones of a SHA-256 digest.
inline constexpr std::size_t kRunDigits = 32;

/// Writes trace.json piece by piece, so that memory holds no more of it than one array's numbers.
/// Where `hypotheses` is not null it has those of all frames. Returns the id of the run: the
/// beginning of the digest of all bytes before the key `run`, the last one.
std::string write_trace(const SlamJob& job, const SlamRun& run, const HypothesisTexts* hypotheses,
                        const TextSink& sink);

/// Writes the part of trace.json that is of one object.
void write_trace_object(JsonWriter& out, const SlamJob& job, const SlamRun& run, std::size_t object,
                        const HypothesisTexts* hypotheses);

}  // namespace posemix::internal
