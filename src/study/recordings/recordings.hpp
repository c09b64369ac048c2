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
  std::string sequence;        ///< such as "0022"
  std::vector<std::string> objects;  ///< ids in results: for DOPE class names, else BOP object ids

  bool operator==(const Recording&) const = default;
};

/// @throws InvalidInput, which tells how to name or to fetch one, when there is no such folder
void require_data_folder(const std::filesystem::path& data);

/// Every recording of a data folder, sorted by detector, object and sequence:
/// - DOPE (TUM, one object): experiments/ycbv/inference/OBJECT/Initial/SEQUENCE.txt in the folder
///   itself or in slam-super-6d/;
/// - CosyPose (npy, all objects of the sequence): midway/cosypose/SEQUENCE/obj_OOOOOO_IIIIII.npy.
///   An object with less than a hundredth of the files of the most frequent one is left out as a
///   stray.
/// - estimators (CSV tables, all objects of a scene that are in the table):
///   consensus-driven-uncertainty/ycbv_ESTIMATOR.csv, a recording per estimator and scene.
/// @throws InvalidInput when the folder is not there, cannot be read or holds no recording
std::vector<Recording> find_recordings(const std::filesystem::path& data);

/// The folder experiments/ycbv of a data folder, if it exists.
std::optional<std::filesystem::path> find_experiments(const std::filesystem::path& data);

/// The text of the built-in sequence file of a detector, with its noise model and filter: for
/// "dope" configs/ycbv-dope.toml, for "cosypose" configs/ycbv-0022.toml, and for "published" the
/// settings of the midway paper's program, configs/ycbv-0022-paper.toml.
/// @throws InvalidInput for another name
std::string_view recording_profile(std::string_view name);

/// The name of the profile for a recording: "cosypose" for recordings of CosyPose, "dope" for all
/// others.
std::string_view profile_name_of(const Recording& recording);

/// The sequence file of one recording, made from a profile: the sequence file of another recording
/// of the same detector, or of tables of estimates on the same scenes.
///
/// The profile's keys `sequence` and `object` are set. An object of a recording with several has
/// the keys of the profile's object of the same id, else of its first. Keys `odometry` and
/// `ground_truth` whose file does not exist (or lacks the object) are left out. Without odometry
/// the profile's motion model is left out too, and constant velocity is used. Without the camera's
/// ground truth the camera starts at the identity.
TomlDocument recording_document(const Recording& recording, std::string_view profile);

/// Reads a recording by its profile, changed by `overrides` (see TomlDocument::apply_override).
/// @throws InvalidInput naming the file that is not valid
SlamJob read_recording(const Recording& recording, std::span<const std::string> overrides = {});

}  // namespace posemix
