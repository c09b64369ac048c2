// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/base/words.hpp"
#include "posemix/lie/lie.hpp"
#include "posemix/lie/pose_covariance.hpp"

namespace posemix {

/// The axes in which a noise covariance is stated. In all cases the rotation is about the origin of
/// the detected mode.
enum class NoiseFrame {
  object,  ///< Y = T_camera_object offset Exp(n), n along the mode's own axes (midway-merge paper,
           ///< eq. 32)
  camera,  ///< the same with n along the camera's axes
  ray      ///< the same with n along the camera's axes after the shortest turn that takes z to the
           ///< viewing ray (from the camera to the mode), and its translation in units of the range
};

/// The words of NoiseFrame in files and options.
template <>
inline constexpr WordTable<NoiseFrame, 3> words<NoiseFrame>{{
    {"object", NoiseFrame::object},
    {"camera", NoiseFrame::camera},
    {"ray", NoiseFrame::ray},
}};

/// One component of a detector's error: with probability `weight` the detection is
///   Y = T_camera_object offset Exp(n),  n ~ N(0, covariance).
struct NoiseComponent {
  double weight = 1.0;
  /// Rotation [rad], then translation [m], for NoiseFrame::ray as a fraction of the range.
  Matrix6d covariance = Matrix6d::Identity();
  NoiseFrame frame = NoiseFrame::object;
  SE3d offset = {};  ///< pose of the detected mode in the object's frame, the identity unless it is
                     ///< a near-symmetry
  /// The covariance with which a detection moves the estimate, where it is not the one that weighs
  /// hypotheses: an error that all frames have in common (a biased range) does not average out, so
  /// that the mean over frames is less certain than their own errors suggest.
  std::optional<Matrix6d> update_covariance = {};
};

/// Detections that do not depend on the pose of the object: with probability `weight` a detection
/// is uniform over all rotations and a volume.
struct Clutter {
  double weight = 0.0;
  double volume_m3 = 1.0;
};

/// The viewing ray of a mode T_camera_mode, to which NoiseFrame::ray refers.
struct ViewingRay {
  SO3d axes;  ///< rotation from its axes to those of the camera; the third axis points to the mode
  double range;  ///< from the camera to the mode [m], at least a millimetre
};

/// The axes are those of the camera after the shortest rotation that takes z to the mode.
ViewingRay viewing_ray(const SE3d& camera_mode);

/// A component for one pose of the object: covariances in metres along axes whose pose in the
/// camera's frame is `axes`, at the origin of the mode and turned according to the component's
/// frame.
struct NoiseAtPose {
  SE3d axes;
  Matrix6d covariance;
  Matrix6d update_covariance;
};

/// The component for an object at the pose `camera_object`. A range below a millimetre counts as
/// one millimetre.
NoiseAtPose noise_at(const NoiseComponent& noise, const SE3d& camera_object);

/// A component of NoiseFrame::ray with its covariances along the camera's axes in metres, for an
/// object at `camera_object`; components of other frames are returned unchanged.
NoiseComponent along_camera(const NoiseComponent& noise, const SE3d& camera_object);

/// Dependence of successive detections. Where it is empty, the settings of a filter decide.
struct NoiseDependence {
  /// Number of detections of an object that count as one.
  std::optional<double> dependent_frames = {};
  /// Covariance of the error that all detections of a recording share, in the frame and the units
  /// of the first component.
  std::optional<Matrix6d> bias = {};
};

/// The error of one detector on one class of objects: a mixture of components (midway-merge paper,
/// eq. 33) and of clutter. Invariant: at least one component, weights positive (clutter's may be
/// zero) and summing to one, covariances symmetric positive definite, a positive volume.
class DetectorNoise {
 public:
  /// Normalises the weights. @throws InvalidInput naming the component when the invariant cannot
  /// hold
  explicit DetectorNoise(std::vector<NoiseComponent> components, Clutter clutter = {},
                         NoiseDependence dependence = {});

  const std::vector<NoiseComponent>& components() const { return components_; }
  const Clutter& clutter() const { return clutter_; }
  const NoiseDependence& dependence() const { return dependence_; }

  /// Log of clutter's weight times its density 1 / (8 pi^2 V) on SE(3) [nats; rad^-3 m^-3]; -inf
  /// for weight zero.
  double log_clutter_density() const;

  /// The single Gaussian with the second moment of the components without an offset, for a filter
  /// with one hypothesis: components with an offset are left out (all kept when every one has an
  /// offset), and so is clutter.
  DetectorNoise single_gaussian() const;

 private:
  std::vector<NoiseComponent> components_;
  Clutter clutter_;
  NoiseDependence dependence_;
};

}  // namespace posemix
