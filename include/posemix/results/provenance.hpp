// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posemix/base/vector_instructions.hpp"

/// Where results come from: the key `provenance` of metrics.json and study.json.
namespace posemix {

/// A file that was read.
struct ProvenanceInput {
  std::filesystem::path path;
  std::string sha256;  ///< 64 hexadecimal digits; empty for a folder
};

/// What made results.
struct Provenance {
  std::vector<std::string> command;   ///< the words of the command line
  std::optional<std::uint64_t> seed;  ///< of random numbers, where there are any
  std::string settings = {};          ///< an object as JSON; empty: not known
  std::vector<ProvenanceInput> inputs = {};
  std::string finished = {};  ///< ISO 8601, UTC
  /// What decides on the last bits of results; empty: not known.
  std::string instructions{vector_instructions()};
};

/// The words as one line that a shell takes apart into the same words.
std::string quoted_command(std::span<const std::string> words);

/// The time now, or that of the environment variable SOURCE_DATE_EPOCH [s since 1970], so that
/// results can be made again byte by byte: `2026-11-23T17:20:42Z`.
std::string utc_now();

/// The files with their digests, in this order and each once; folders and what cannot be read have
/// none.
std::vector<ProvenanceInput> provenance_inputs(std::span<const std::filesystem::path> paths);

/// The text of study.json (an object as JSON with an indent of one) with the keys `files`, the
/// names of all files of the study, and `provenance`.
/// @throws InvalidInput for another text
std::string study_with_provenance(const std::string& study, const Provenance& provenance,
                                  std::span<const std::string> files);

}  // namespace posemix
