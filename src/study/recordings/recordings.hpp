// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/config/sequence_file.hpp"

/// The recordings of a data folder.
namespace posemix {

/// A sequence for which the folder has detections.
struct Recording {
  std::filesystem::path data;  ///< the data folder
  std::string detector;        ///< "dope", "cosypose", or the estimator of a table
  std::string object;          ///< folder name of the object's class; "all" for several objects
  std::string sequence;        ///< as "0022"
  std::vector<std::string> objects;  ///< ids in results; but for dope BOP object ids

  bool operator==(const Recording&) const = default;
};

/// Every recording of a data folder, sorted by detector, object and sequence:
/// - DOPE (TUM, one object): experiments/ycbv/inference/OBJECT/Initial/SEQUENCE.txt in the folder
///   itself or in slam-super-6d/;
/// - CosyPose (npy, all objects of the sequence): midway/cosypose/SEQUENCE/obj_OOOOOO_IIIIII.npy.
///   An object with less than a hundredth of the files of the most frequent one is left out as a
///   stray.
/// - estimators (CSV tables, all objects of a scene that are in the table):
///   consensus-driven-uncertainty/ycbv_ESTIMATOR.csv, a recording per estimator and scene.
/// @throws InvalidInput when the folder cannot be read or holds no recording
std::vector<Recording> find_recordings(const std::filesystem::path& data);

/// The folder experiments/ycbv of a data folder, where there is one.
std::optional<std::filesystem::path> find_experiments(const std::filesystem::path& data);

/// The sequence file in which this library sets a detector's noise model and filter: of "dope"
/// configs/ycbv-dope.toml, of "cosypose" configs/ycbv-0022.toml, and of "published" the settings of
/// the midway paper's program, configs/ycbv-0022-paper.toml.
/// @throws InvalidInput for another name
std::string_view recording_profile(std::string_view name);

/// The name of the profile by which a recording is read: that of CosyPose for its recordings, that
/// of DOPE for all others.
std::string_view profile_name_of(const Recording& recording);

/// The sequence file of one recording, from a profile that was written for another one with the
/// same detector, or for tables of estimates on the same scenes.
///
/// The profile's keys `sequence` and `object` are set. An object of a recording with several has
/// the keys of the profile's object of the same id, else of its first. Keys `odometry` and
/// `ground_truth` whose file is not there (or does not hold the object) are left out; without
/// odometry also the profile's motion model, which is then constant velocity, and without the
/// camera's ground truth it starts at the identity.
TomlDocument recording_document(const Recording& recording, std::string_view profile);

/// Reads a recording by its profile; `overrides` as for
/// TomlDocument::apply_override.
/// @throws InvalidInput naming the file that is not valid
SlamJob read_recording(const Recording& recording, std::span<const std::string> overrides = {});

}  // namespace posemix
