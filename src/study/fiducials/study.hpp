// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "peer.hpp"
#include "posemix/base/words.hpp"
#include "posemix/config/toml_table.hpp"
#include "study/engine/study.hpp"

/// SLAM on recordings of square tags.
namespace posemix {

/// What the filter is told of a sighting.
enum class FiducialInput {
  weights,  ///< all components with their weights
  equal,    ///< all components with equal weights
  best      ///< the heaviest component alone
};

/// The words of FiducialInput in settings and tables.
template <>
inline constexpr WordTable<FiducialInput, 3> words<FiducialInput>{{
    {"weights", FiducialInput::weights},
    {"equal", FiducialInput::equal},
    {"best", FiducialInput::best},
}};

/// Settings of `study fiducials`.
struct FiducialsStudySettings {
  std::filesystem::path data = {};           ///< the data folder
  std::filesystem::path folder = "tagslam";  ///< of the recordings, below the data folder
  std::vector<std::string> recordings = {};  ///< names; empty: all
  std::vector<FiducialInput> inputs = {FiducialInput::weights, FiducialInput::equal,
                                       FiducialInput::best};
  std::vector<FiducialPeer> peers = {};     ///< run on the same recordings
  bool priors = true;                       ///< whether surveyed tags are known to the filter
  std::optional<double> size_m = {};        ///< edge of tags whose size is not stated
  std::vector<std::string> overrides = {};  ///< of the sequence files, as for --set
};

/// Reads the settings: `folder`, `recordings`, `inputs`, `peers`, `priors`, `size_m` and `set`.
/// @throws InvalidInput as TomlTable does
FiducialsStudySettings read_fiducials_settings(const TomlTable& table);

/// The study: every recording with every input, and with every peer. Tags are observed by
/// observe_fiducials with its defaults, the sequence file is that of `posemix fiducials`, and the
/// filter that of `posemix slam`.
///
/// Report: study.json and fiducials.csv (a row per recording and input or peer), tags.csv (a row
/// per tag), timing.csv, camera.svg (distance to the reference over time).
/// @throws InvalidInput when there are no recordings, or none of a name
Study make_fiducials_study(const FiducialsStudySettings& settings);

}  // namespace posemix
