// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

/// Sequence files for scenes of dataset folders.
namespace posemix {

/// What the sequence file of a scene is made from.
struct DatasetSequence {
  std::filesystem::path dataset;  ///< folder of a BOP dataset or of YCB-Video
  std::string split = "test";     ///< of a BOP dataset
  std::int64_t scene = 0;
  std::filesystem::path results;      ///< BOP result file of a detector
  std::vector<std::int64_t> objects;  ///< ids; empty: all that have estimates
  std::optional<double> min_score;
  std::optional<std::filesystem::path> odometry;  ///< TUM file
  std::optional<Eigen::Vector3d> lever_arm_m;
  std::optional<double> frame_period_s;
};

struct DatasetSequenceText {
  std::string toml;                ///< for `posemix slam`; paths are absolute
  std::vector<std::string> notes;  ///< what the file leaves out or assumes, a sentence each
};

/// The sequence file: the camera's and objects' ground truth where the dataset has it, detections
/// from the result file, symmetries where the dataset has models. Of a class with several instances
/// in one image it has as many objects, which share its detections as candidates.
/// @throws InvalidInput naming folder, file or object
DatasetSequenceText format_dataset_sequence(const DatasetSequence& request);

}  // namespace posemix
