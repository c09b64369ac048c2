// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>

#include "posemix/detector/default_noise.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/symmetry.hpp"

/// The objects that object SLAM may see.
namespace posemix {

/// The model of one object: how it is detected, and what is known of it.
struct ObjectModel {
  std::string id;
  DetectorNoise noise = default_detector_noise();
  /// Covariance (world frame) with which the object starts independently of everything else. Empty,
  /// the default: it starts from its first detection with the detector's noise and its full
  /// cross-covariance.
  std::optional<Matrix6d> independent_start = {};
  /// Motions of the object's frame that leave its appearance as it is; for the multi-object filter.
  SymmetryGroup symmetries = {};
  /// Objects that no detector can tell apart share a class; FrameInput::candidates are of classes.
  /// They are alike: noise and symmetries of a class are those of its first model. Empty: the
  /// object is a class of its own, named as its id.
  std::string class_id = {};
};

}  // namespace posemix
