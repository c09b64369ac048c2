// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posemix/base/words.hpp"

namespace posemix {

/// The form of an observation file.
enum class ObservationFormat {
  csv,   ///< one row per component, poses with 12 digits
  jsonl  ///< one line per sighting, all digits
};

/// The words of ObservationFormat in options.
template <>
inline constexpr WordTable<ObservationFormat, 2> words<ObservationFormat>{{
    {"csv", ObservationFormat::csv},
    {"jsonl", ObservationFormat::jsonl},
}};

/// What `posemix convert SEQUENCE.toml` was asked for.
struct SequenceConversion {
  std::string sequence;
  std::optional<std::string> data;
  std::vector<std::string> overrides;
  std::string out;
  ObservationFormat format = ObservationFormat::jsonl;
  bool quiet = false;
};

/// Writes a folder with a sequence file whose detections are observations. Returns the exit code.
int convert_sequence(const SequenceConversion& options);

}  // namespace posemix
