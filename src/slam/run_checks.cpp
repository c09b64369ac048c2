// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/run_checks.hpp"

#include <string_view>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix::internal {
namespace {

void check_entries(std::string_view what, std::size_t got, std::size_t expected) {
  if (got != expected)
    throw InvalidInput(fmt::format("the run has {} {}, expected {}", got, what, expected));
}

/// What a tracker may leave out.
void check_entries_or_none(std::string_view what, std::size_t got, std::size_t expected) {
  if (got != 0) check_entries(what, got, expected);
}

void check_frame(const FrameEstimate& frame, std::size_t objects) {
  check_entries("objects", frame.objects.size(), objects);
  check_entries("relative poses", frame.relative.size(), objects);
  check_entries("statuses", frame.report.statuses.size(), objects);
  check_entries_or_none("indices of poses", frame.pose_indices.size(), objects);
  check_entries_or_none("lists of alternatives", frame.alternatives.size(), objects);
  check_entries_or_none("probabilities of modes", frame.mode_probabilities.size(), objects);
  // What the multi-object tracker says of tracks, all of it or nothing.
  check_entries_or_none("existences", frame.existences.size(), objects);
  check_entries("healths", frame.healths.size(), frame.existences.size());
  check_entries("entries of register_again", frame.register_again.size(), frame.existences.size());
  check_entries_or_none("values of NIS", frame.report.nis.size(), objects);
  check_entries_or_none("lists of models of motion", frame.motion_models.size(), objects);
  check_entries_or_none("twists", frame.twists.size(), objects);
}

}  // namespace

void require_fit(const Sequence& sequence, const SlamRun& run) {
  require(!run.frames.empty(), "the run has no frame");
  if (run.frames.size() > sequence.stamps.size()) {
    throw InvalidInput(fmt::format("the run has {} frames, the sequence {}", run.frames.size(),
                                   sequence.stamps.size()));
  }
  for (const FrameEstimate& frame : run.frames) check_frame(frame, sequence.objects.size());
  validate(sequence);
}

void require_fit(const SlamJob& job, const SlamRun& run) {
  require_fit(job.sequence, run);
  if (job.models.size() != job.sequence.objects.size())
    throw InvalidInput(fmt::format("there are {} models of {} objects", job.models.size(),
                                   job.sequence.objects.size()));
  check_entries("indices of poses", run.pose_indices.size(), job.models.size());
  check_entries_or_none("lists of hypotheses", run.hypotheses.size(), job.models.size());
  for (const auto& index : run.pose_indices)
    if (index && *index >= run.posterior[0].density.mean().size())
      throw InvalidInput(fmt::format("the run has pose {} of a posterior of {} poses", *index,
                                     run.posterior[0].density.mean().size()));
}

void require_fit(const SlamJob& job, const Metrics& metrics) {
  if (metrics.objects.size() != job.models.size())
    throw InvalidInput(fmt::format("there are metrics of {} objects, expected {}",
                                   metrics.objects.size(), job.models.size()));
}

}  // namespace posemix::internal
