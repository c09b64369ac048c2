// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "posemix/base/words.hpp"

namespace posemix {

/// How a lens bends the image of a pinhole.
enum class DistortionModel {
  none,
  radtan,      ///< radial and tangential: k1 k2 p1 p2 [k3], OpenCV's without further terms
  equidistant  ///< of the angle to the axis: k1 k2 k3 k4, OpenCV's fisheye (Kannala-Brandt)
};

/// The words of DistortionModel in files and options; those of kalibr, TagSLAM and ROS.
template <>
inline constexpr WordTable<DistortionModel, 3> words<DistortionModel>{{
    {"none", DistortionModel::none},
    {"radtan", DistortionModel::radtan},
    {"equidistant", DistortionModel::equidistant},
}};

/// A point in an image, and how it moves with the point of space.
struct Projection {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();                             ///< [px]
  Eigen::Matrix<double, 2, 3> jacobian = Eigen::Matrix<double, 2, 3>::Zero();  ///< [px/m]
};

/// A calibrated camera: x right, y down, z forward.
struct CameraModel {
  Eigen::Vector4d intrinsics = {1.0, 1.0, 0.0, 0.0};  ///< fx, fy, cx, cy [px]
  DistortionModel distortion = DistortionModel::none;
  std::vector<double> coefficients = {};  ///< of the distortion: none, 4 or 5 (radtan), 4
};

/// @throws InvalidInput when a number is not finite, a focal length is not positive, or the number
/// of coefficients is not that of the distortion
void validate(const CameraModel& camera);

/// The image of a point in the camera's frame [m]; nothing where the camera has none: for
/// `equidistant` at the camera's centre, for the others from z = 0 on backwards.
/// @throws InvalidInput when the number of coefficients is not that of the distortion; `ray`, too
std::optional<Projection> project(const CameraModel& camera, const Eigen::Vector3d& point);

/// The unit vector towards what is seen at a distorted pixel, by Newton's method on the distortion.
/// Nothing where that does not converge: the pixel is beyond what the distortion can reach.
std::optional<Eigen::Vector3d> ray(const CameraModel& camera, const Eigen::Vector2d& pixel);

/// The angle that a length near the centre of the image stands for [rad].
double angle_of_pixels(const CameraModel& camera, double pixels);

}  // namespace posemix
