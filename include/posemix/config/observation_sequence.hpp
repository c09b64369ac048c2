// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "posemix/config/toml_table.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/slam/sequence.hpp"

/// Recordings of any kind as recordings with observations.
namespace posemix {

/// All that detectors saw in a recording as observations, frame by frame in the order in which the
/// filter takes them: detections of the objects, then candidates.
std::vector<Observation> observations_of(const Sequence& sequence);

/// What a sequence file with observations names in its own folder.
struct ObservationSequenceFiles {
  std::string key;           ///< `csv` or `jsonl`
  std::string observations;  ///< name of the observation file
  std::string stamps;        ///< name of the file with the stamps of all frames
};

/// The text of a sequence file that is as the document, overrides included, but for its detections
/// and candidates, in whose place it names a file of observations. Other files are looked up in its
/// own folder, then where those of the document are (`folders`, as for read_slam_job), by absolute
/// paths.
std::string format_observation_sequence(const TomlDocument& document,
                                        const std::vector<std::filesystem::path>& folders,
                                        const ObservationSequenceFiles& files);

/// @throws InvalidInput, with what differs, unless two recordings have the same frames, odometry
/// and ground truth to the last bit
void require_same_frames(const Sequence& a, const Sequence& b);

}  // namespace posemix
