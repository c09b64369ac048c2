// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

/// Writes sequence files for scenes of datasets.
namespace posemix {

/// The request for the sequence file of a scene.
struct DatasetSequence {
  std::filesystem::path dataset;  ///< folder of a BOP dataset or of YCB-Video
  std::string split = "test";     ///< split of a BOP dataset
  std::int64_t scene = 0;
  std::filesystem::path results;      ///< BOP result file of a detector
  std::vector<std::int64_t> objects;  ///< ids of objects; empty: all with estimates
  std::optional<double> min_score;
  std::optional<std::filesystem::path> odometry;  ///< TUM file
  std::optional<Eigen::Vector3d> lever_arm_m;
  std::optional<double> frame_period_s;
};

/// A sequence file and remarks about it.
struct DatasetSequenceText {
  std::string toml;                ///< for `posemix slam`; paths are absolute
  std::vector<std::string> notes;  ///< one sentence each on what the file leaves out or assumes
};

/// Writes the sequence file: ground truth of camera and objects if the dataset has it, detections
/// from the result file, symmetries if the dataset has models. A class with several instances in
/// one image becomes as many objects, which share its detections as candidates.
/// @throws InvalidInput naming folder, file or object
DatasetSequenceText format_dataset_sequence(const DatasetSequence& request);

}  // namespace posemix
