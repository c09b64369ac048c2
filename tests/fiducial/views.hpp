// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include "posemix/base/random.hpp"
#include "posemix/fiducial/tag_pose.hpp"

/// Random views of tags.
namespace posemix::testing {

inline constexpr double kTagSize = 0.15;

inline CameraModel pinhole_camera() { return {.intrinsics = {600.0, 602.0, 640.0, 512.0}}; }

inline CameraModel radtan_camera() {
  CameraModel camera = pinhole_camera();
  camera.distortion = DistortionModel::radtan;
  camera.coefficients = {-0.2, 0.05, 0.001, -0.0005};
  return camera;
}

inline CameraModel fisheye_camera() {
  CameraModel camera = pinhole_camera();
  camera.distortion = DistortionModel::equidistant;
  camera.coefficients = {-0.013, -0.0099, 0.0121, -0.0045};
  return camera;
}

/// T_camera_tag of a tag `distance` metres away in the direction of a point of the image plane,
/// whose normal is `tilt` [rad] from the line of sight, about the axis at `azimuth`.
inline SE3d view(double distance, double tilt, double azimuth = 0.3, double turn = 0.5,
                 const Eigen::Vector2d& at = {0.1, -0.05}) {
  const Eigen::Vector3d sight = at.homogeneous().normalized();
  // Rotated by pi about x the tag faces the camera.
  const SO3d facing = SO3d::exp({M_PI, 0.0, 0.0}) * SO3d::exp({0.0, 0.0, turn});
  const SO3d to_sight =
      SO3d::from_quaternion(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), sight));
  const SO3d tilted = SO3d::exp(tilt * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0));
  return SE3d(to_sight * tilted * facing, distance * sight);
}

inline TagCorners image_of(const SE3d& camera_tag, const CameraModel& camera,
                           double size = kTagSize) {
  TagCorners corners;
  const auto points = tag_points(size);
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = project(camera, camera_tag * points[i]).value().pixel;
  return corners;
}

inline TagCorners with_noise(TagCorners corners, double sd_px, RandomStream& stream) {
  for (Eigen::Vector2d& corner : corners)
    corner += sd_px * Eigen::Vector2d(stream.normal(), stream.normal());
  return corners;
}

}  // namespace posemix::testing
