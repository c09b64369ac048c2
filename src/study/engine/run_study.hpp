// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ranks.hpp"
#include "study.hpp"

namespace posemix {

/// Options of `run_study`.
struct StudyRunOptions {
  std::size_t threads = 0;             ///< of this rank; 0: the host's cores shared among its ranks
  std::filesystem::path journal = {};  ///< file of finished items (rank 0); empty: none is kept
  bool resume = false;                 ///< continue with the results in the journal
  /// Called on rank 0, many times a second, with (items done, items in all); returning false stops
  /// the study.
  std::function<bool(std::size_t, std::size_t)> progress = {};
};

/// Results of `run_study`.
struct StudyRun {
  Study study;
  std::vector<std::string> results;  ///< results of all items, in order; empty if it was stopped
  bool complete = false;
  /// The vector instructions of all results; empty where some are from a journal of a program
  /// before 0.3.
  std::string instructions;
};

/// Runs all items of a study on all threads of all ranks.
///
/// Every rank calls this; every rank makes the study for itself. Rank 0 hands out items as others
/// finish, in chunks where they take little time (`Schedule`), writes the journal and gets the
/// results; the rest get nothing back. The journal of a study that was stopped, or that died, is
/// kept; the caller removes the journal of a complete study once its report is written. When `make`
/// or an item throws on any rank, no rank begins another item and rank 0 throws.
/// @throws InvalidInput as Journal, and when the ranks do not agree on the study or on vector
/// instructions
std::optional<StudyRun> run_study(Ranks& ranks, const std::function<Study()>& make,
                                  const StudyRunOptions& options = {});

}  // namespace posemix
