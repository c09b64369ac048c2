// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "posemix/detector/default_noise.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/symmetry.hpp"
#include "posemix/filter/motion_models.hpp"
#include "posemix/filter/object_prior.hpp"

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
  /// Their noise and symmetries are the same. Empty: the object is a class of its own, named as its
  /// id.
  std::string class_id = {};
  /// Noise by the name of the detector (Observation::detector), for the multi-object filter. A name
  /// that is not here is an error, unless there is none at all; no name stands for `noise`.
  std::map<std::string, DetectorNoise> detectors = {};
  /// Where the object is known to be, for the multi-object filter.
  std::optional<ObjectPrior> prior = {};
  /// How the object moves, for the multi-object filter. One that neither stands still nor is put
  /// down elsewhere is tracked for itself and tells nothing of the camera (docs/moving-objects.md).
  MotionModels motion = {};
};

/// The class of a model, which is its id where no class is given.
const std::string& class_of(const ObjectModel& model);

/// @throws InvalidInput naming two models of one class whose noise or symmetries differ
void require_alike_in_class(std::span<const ObjectModel> models);

}  // namespace posemix
