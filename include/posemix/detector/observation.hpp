// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/lie/lie.hpp"

/// What a detector says of one object in one image.
namespace posemix {

/// One of the poses that a detector takes for possible.
struct ObservationComponent {
  double weight = 1.0;  ///< those of an observation sum to one
  SE3d pose = {};       ///< T_camera_object
  /// Covariance of the white error n of Y = T_camera_object Exp(n) (right perturbation, along the
  /// object's axes), rotation [rad] before translation [m], see GivenCovariance. None: that of the
  /// detector's noise.
  std::optional<Matrix6d> covariance = {};
};

/// One sighting of one object: a mixture. The components exclude each other: given that the
/// observation is of the object, one of them is its pose up to the detector's error, with a
/// probability of its weight if nothing else is known.
struct Observation {
  /// Id of the object model; empty where only the class is known.
  std::string object = {};
  /// Where `object` is empty: class of the object; the instance is found by association.
  std::string class_id = {};
  std::vector<ObservationComponent> components = {};
  /// Probability that the observation is of no object, in place of that of the detector's noise.
  std::optional<double> clutter = {};
  std::string camera = {};           ///< name of the camera of a rig; empty where there is one
  std::string detector = {};         ///< name of the detector; empty where there is one
  double stamp_s = 0.0;              ///< time of the image
  std::optional<double> score = {};  ///< the detector's confidence in the sighting, larger is surer
};

/// The observation of one pose.
Observation observation_of(const SE3d& camera_object);

/// Index of the component of the largest weight, the first of equal ones.
/// @throws InvalidInput for an observation without components
std::size_t best_component(const Observation& observation);

/// @throws InvalidInput when there is no component, as check_pose for a pose, a weight is not
/// finite or negative, their sum not one (to a thousandth), as check_variances for a covariance and
/// when it is not symmetric positive definite, the probability of clutter is not in (0, 1 - 1e-9],
/// the stamp beyond kLatestStamp, or the score not finite; it names the component
void validate(const Observation& observation);

}  // namespace posemix
