// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "posemix/config/toml_table.hpp"
#include "study/engine/study.hpp"

/// Whether the default filter is as sure as it is right: simulated recordings with the errors that
/// detectors have, of which the filter is told no more than the detector's model.
namespace posemix {

/// The symmetry of the objects of a cell.
enum class ObjectShape { plain, axis, ball, half_turn };

/// What the camera's motion is known from.
enum class OdometryQuality { good, medium, none };

/// What is told of a detector that sees the object and its half turn as one, and has other evidence
/// of which of the two it is: a weight u, uniform from zero to one (the Beta distribution with both
/// parameters one), with which the first of the two is the right one.
enum class ModeInput {
  none,     ///< the detector is not one
  mixture,  ///< both poses with their weights, u and 1 - u
  best      ///< the pose of the larger weight; one of four is the wrong one
};

/// One kind of recording. Detections come ten times a second.
struct ConsistencyCell {
  std::string name;
  std::size_t objects = 1;
  ObjectShape shape = ObjectShape::plain;
  OdometryQuality odometry = OdometryQuality::medium;
  bool slow = true;  ///< else all of the error is white
  /// Correlation lengths of the slow error.
  double correlation_s = std::numeric_limits<double>::infinity();
  double correlation_angle_deg = std::numeric_limits<double>::infinity();
  double seen_s = 60.0;           ///< detections come for so long
  double pause_s = 0.0;           ///< then none for so long
  std::size_t turns = 1;          ///< how often both follow each other
  double flips = 0.0;             ///< fraction of the frames, in runs of two seconds
  double clutter = 0.0;           ///< fraction of the detections
  std::size_t wrong_starts = 0;   ///< first detections that are flipped
  double late_s = 0.0;            ///< time at which the last object appears
  bool default_detector = false;  ///< the errors of default_detector_noise()
  bool candidates = false;        ///< detections name a class of two objects instead of the object
  ModeInput modes = ModeInput::none;
  bool modes_in_runs = false;  ///< weights and which mode is right last for two seconds in the mean
  double first_look_s = 5.0;   ///< estimates are compared with the truth from this time on
  double look_every_s = 1.0;
};

/// The kinds of recordings of the study, in its order.
const std::vector<ConsistencyCell>& consistency_cells();

struct ConsistencyStudySettings {
  std::size_t runs = 50;  ///< recordings of each kind
  std::uint64_t seed = 1;
  std::vector<std::string> cells = {};  ///< names of kinds; all where empty
};

/// @throws InvalidInput naming file, line and key
ConsistencyStudySettings read_consistency_settings(const TomlTable& table);

/// The study: one work item per recording. A row per kind: ANEES of camera, objects in the world
/// and objects from the camera with standard errors, coverage, the probability of the mode and how
/// often it was right, and known instances that were duplicated after a pause.
Study make_consistency_study(const ConsistencyStudySettings& settings);

}  // namespace posemix
