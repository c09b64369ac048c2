// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "dependence.hpp"
#include "joint_gaussian.hpp"
#include "posemix/filter/multi_object_filter.hpp"

/// The hypotheses of one object, one of which lies in the joint Gaussian. In the room `filter`
/// only.
namespace posemix::internal {

/// One object. The leading hypothesis' pose and covariances are those of the joint Gaussian at
/// `index`; the entry of the list holds the rest.
struct ObjectState {
  ObjectSensor sensor;
  Vector6d given_noise_scale = sensor.noise_scale;  ///< before anything was learned
  std::vector<ObjectHypothesis> hypotheses = {};
  double log_absent = 0.0;
  std::size_t leading = 0;
  std::optional<std::size_t> index = {};
  double seen = 0.0;  ///< detections that taught the noise's scale
  std::uint64_t detections = 0;
  double first_s = 0.0;  ///< time of the first detection
  double last_s = 0.0;   ///< and of the last
  DependentFrames dependence = {};
  Matrix6d drift = Matrix6d::Zero();  ///< of the map, up to the last detection
};

/// Camera and hypothesis h, from the joint Gaussian where it leads.
Pair pair_of(const JointGaussian& joint, const ObjectState& object, std::size_t h);

/// Hypotheses that do not lead follow the camera: xi_O = G xi_C + rest, where the camera's moments
/// have changed from (`mean`, `covariance`) to (`new_mean`, `new_covariance`), all in the tangent
/// space before the change.
void follow_camera(ObjectHypothesis& hypothesis, const Vector6d& mean, const Matrix6d& covariance,
                   const Vector6d& new_mean, const Matrix6d& new_covariance);

/// Bounds of `merge_hypotheses`, from the settings.
struct MergeBounds {
  double rotation_rad;
  double translation_m;
  double squared_distance;
};

/// Merges hypotheses that agree. Returns how many merges there were.
std::size_t merge_hypotheses(JointGaussian& joint, ObjectState& object, const MergeBounds& bounds);

/// Keeps the heaviest, and of the others those of the best score, the newest of equals.
void keep_best(ObjectState& object, std::size_t most, std::size_t protected_hypotheses);

/// Normalises the weights together with that of absence.
void normalise(ObjectState& object);

/// Lets the heaviest hypothesis lead where it is ahead by more than `margin`. Returns whether the
/// lead changed.
bool choose_leader(JointGaussian& joint, ObjectState& object, double margin);

}  // namespace posemix::internal
