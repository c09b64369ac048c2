// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {

/// The axes in which a noise covariance is stated. In both cases the rotation is about the origin
/// of the detected mode.
enum class NoiseFrame {
  object,  ///< Y = T_camera_object offset Exp(n), n along the mode's own axes (midway-merge paper,
           ///< eq. 32)
  camera   ///< the same with n along the camera's axes
};

/// One component of a detector's error: with probability `weight` the detection is
///   Y = T_camera_object offset Exp(n),  n ~ N(0, covariance).
struct NoiseComponent {
  double weight = 1.0;
  Matrix6d covariance = Matrix6d::Identity();  ///< rotation [rad], then translation [m]
  NoiseFrame frame = NoiseFrame::object;
  SE3d offset = {};  ///< pose of the detected mode in the object's frame, the identity unless it is
                     ///< a near-symmetry
};

/// The error of one detector on one class of objects: a mixture of components (midway-merge paper,
/// eq. 33). Invariant: at least one component, weights positive and summing to one, covariances
/// symmetric positive definite.
class DetectorNoise {
 public:
  /// Normalises the weights. @throws InvalidInput naming the component when the invariant cannot
  /// hold
  explicit DetectorNoise(std::vector<NoiseComponent> components);

  const std::vector<NoiseComponent>& components() const { return components_; }

  /// The single Gaussian with the second moment of the components without an offset, for a filter
  /// with one hypothesis: components with an offset are left out (all kept when every one has an
  /// offset).
  DetectorNoise single_gaussian() const;

 private:
  std::vector<NoiseComponent> components_;
};

/// Diagonal covariance from standard deviations about and along x, y, z.
Matrix6d pose_covariance(const Eigen::Vector3d& rotation_sd_rad,
                         const Eigen::Vector3d& translation_sd_m);

}  // namespace posemix
