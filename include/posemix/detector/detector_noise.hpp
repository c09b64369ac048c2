// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/base/state_fields.hpp"
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
///   Y = T_camera_object offset Exp(b + n),  n ~ N(0, covariance),
/// with the slow error b of the detector (SlowError), zero where it has none.
struct NoiseComponent {
  double weight = 1.0;
  /// Of the white error n. Rotation [rad], then translation [m], for NoiseFrame::ray as a fraction
  /// of the range.
  Matrix6d covariance = Matrix6d::Identity();
  NoiseFrame frame = NoiseFrame::object;
  SE3d offset = {};  ///< pose of the detected mode in the object's frame, the identity unless it is
                     ///< a near-symmetry
  /// Number of successive detections that have the same error, at least one. Above one the
  /// component is one of gross errors: they are likely about the pose with any slow error, not with
  /// the one that lasts, and each has the information of 1 / run_length detections.
  double run_length = 1.0;
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
  /// Factors from the units of the component to radians and metres: those of NoiseFrame::ray have
  /// the range for the translation.
  Vector6d units = Vector6d::Ones();
};

/// The component for an object at the pose `camera_object`. A range below a millimetre counts as
/// one millimetre.
NoiseAtPose noise_at(const NoiseComponent& noise, const SE3d& camera_object);

/// A component of NoiseFrame::ray with its covariances along the camera's axes in metres, for an
/// object at `camera_object`; components of other frames are returned unchanged.
NoiseComponent along_camera(const NoiseComponent& noise, const SE3d& camera_object);

/// The angle between the directions from the object to the camera at two poses T_camera_object, in
/// the axes of the object [rad]; zero where the camera is at the object itself.
double view_angle(const SE3d& first, const SE3d& second);

/// The slow part of a detector's error: a stationary Gaussian process b(t) that is added to the
/// white part, Y = T_camera_object offset Exp(b + n). The correlation of b between two detections
/// of an object is exp(-angle / correlation_angle_rad - time / correlation_time_s), with the angle
/// of the path of the viewing direction, seen from the object, between the two.
struct SlowError {
  Matrix6d covariance = Matrix6d::Identity();  ///< of b, in the frame and units of the components
  double correlation_time_s = std::numeric_limits<double>::infinity();
  double correlation_angle_rad = std::numeric_limits<double>::infinity();

  /// The correlation over a time [s] and an angle of view [rad].
  double correlation(double time_s, double angle_rad) const {
    return std::exp(-angle_rad / correlation_angle_rad - time_s / correlation_time_s);
  }
};

/// What a covariance that an observation brings itself is to the filter. It stands for the white
/// covariance of the first component of the detector's noise; those of other components are wider
/// or narrower than it by the factor by which they are in the noise (the sixth root of the ratio of
/// determinants).
enum class GivenCovariance {
  scaled,    ///< the covariance of the white error, times the scale that is learned
  as_given,  ///< the covariance of the white error
  ignored    ///< nothing: the white error is that of the noise
};

/// The words of GivenCovariance in files and options.
template <>
inline constexpr WordTable<GivenCovariance, 3> words<GivenCovariance>{{
    {"scaled", GivenCovariance::scaled},
    {"as_given", GivenCovariance::as_given},
    {"ignored", GivenCovariance::ignored},
}};

/// Dependence of successive detections of an object.
struct NoiseDependence {
  std::optional<SlowError> slow =
      {};  ///< none: the errors of successive detections are independent
  /// Covariance of the error that all detections of a recording have in common, along the object's
  /// axes [rad, m]: it cannot be told from the pose of the object.
  std::optional<Matrix6d> common = {};
  /// Time for which a detector stays with one mode or with clutter: the weights of detections
  /// within it count as those of one detection [s].
  double mode_time_s = 0.0;
  /// Whether the numbers are those of detectors in general and not of this one. A filter then
  /// trusts them less (MultiObjectSettings::camera_gain).
  bool is_typical = false;
  /// How covariances of observations are used.
  GivenCovariance given_covariance = GivenCovariance::scaled;
};

/// The error of one detector on one class of objects: a mixture of components (midway-merge paper,
/// eq. 33) and of clutter, a slow error and an error in common. Invariant: at least one component,
/// weights positive (clutter's may be zero) and summing to one, run lengths of at least one,
/// covariances symmetric positive definite (that of the error in common may be semidefinite), a
/// positive volume, positive correlation lengths, a mode time of at least zero.
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

  /// The model for filters that take successive errors for independent: the covariances of the slow
  /// error and of the error in common are a part of every component's, and there is no dependence.
  /// Components of frames other than NoiseFrame::object take the error in common along their own
  /// axes, for NoiseFrame::ray at a range of one metre.
  DetectorNoise as_white() const;
  /// Whether the model is its own as_white(), apart from the mode time.
  bool is_white() const;

  /// The single Gaussian with the second moment of the components without an offset, for a filter
  /// with one hypothesis: components with an offset are left out (all kept when every one has an
  /// offset), and so is clutter.
  DetectorNoise single_gaussian() const;

 private:
  template <class>
  friend struct internal::StateFields;

  std::vector<NoiseComponent> components_;
  Clutter clutter_;
  NoiseDependence dependence_;
};

}  // namespace posemix
