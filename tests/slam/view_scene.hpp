// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <vector>

#include "posemix/slam/fuse_views.hpp"

/// Views around objects, for tests of their fusion.
namespace posemix::testing::views {

/// T_world_camera at an angle about the world's z axis, looking at the origin from `range` [m].
inline SE3d camera_at(double angle_deg, double range = 0.8) {
  const double angle = radians(angle_deg);
  const Eigen::Vector3d z(-std::cos(angle), -std::sin(angle), 0.0);
  const Eigen::Vector3d y(0.0, 0.0, -1.0);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() << y.cross(z), y, z;
  matrix.topRightCorner<3, 1>() = -range * z;
  return SE3d::from_matrix(matrix);
}

inline SE3d object_at(double x = 0.0, double y = 0.0) {
  return SE3d(SO3d::exp({0.3, -0.2, 0.5}), {x, y, 0.02});
}

inline SE3d turn(double deg) {
  return SE3d(SO3d::exp({0.0, 0.0, radians(deg)}), Eigen::Vector3d::Zero());
}

/// White errors along the ray, wide along it.
inline DetectorNoise white_noise(double clutter = 0.1) {
  return DetectorNoise({{.weight = 1.0 - clutter,
                         .covariance = pose_covariance({0.03, 0.03, 0.02}, {0.004, 0.004, 0.04}),
                         .frame = NoiseFrame::ray}},
                       {.weight = clutter});
}

/// The same with three quarters of the variance slow.
inline DetectorNoise slow_noise(double angle_deg) {
  NoiseComponent component = white_noise().components().front();
  const SlowError slow{.covariance = 0.75 * component.covariance,
                       .correlation_angle_rad = radians(angle_deg)};
  component.covariance *= 0.25;
  return DetectorNoise({component}, {.weight = 0.1}, {.slow = slow});
}

inline Observation seen(const SE3d& camera_object) {
  Observation observation = observation_of(camera_object);
  observation.class_id = "cup";
  return observation;
}

/// Views around the object, each with an exact observation of every pose.
inline std::vector<View> exact_views(const std::vector<SE3d>& objects, int count = 4) {
  std::vector<View> views;
  for (int v = 0; v < count; ++v) {
    View view{camera_at(50.0 * v), {}};
    for (const SE3d& object : objects)
      view.observations.push_back(seen(view.world_camera.inverse() * object));
    views.push_back(view);
  }
  return views;
}

/// Y of an object at T_camera_object with an error along the ray's axes.
inline SE3d with_error(const SE3d& camera_object, const Vector6d& error,
                       const DetectorNoise& noise) {
  const NoiseAtPose at = noise_at(noise.components().front(), camera_object);
  return at.axes * SE3d::exp(at.units.cwiseProduct(error)) * at.axes.inverse() * camera_object;
}

inline double position_error(const FusedInstance& instance, const SE3d& truth) {
  return (instance.density[0].density.mean().translation() - truth.translation()).norm();
}

}  // namespace posemix::testing::views
