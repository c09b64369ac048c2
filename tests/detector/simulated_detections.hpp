// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/noise_observation.hpp"

/// Detections with the errors of a noise model, drawn by its definition, not by the code under
/// test.
namespace posemix::testing {

inline Vector6d normal_vector(RandomStream& stream) {
  Eigen::VectorXd n(6);
  stream.fill_normal(n);
  return n;
}

inline SO3d uniform_rotation(RandomStream& stream) {
  Eigen::VectorXd q(4);
  stream.fill_normal(q);
  return SO3d::from_quaternion(Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized());
}

/// An object before the camera, 0.4 to 1.6 m away, up to 30 degrees off its axis.
inline SE3d pose_before_camera(RandomStream& stream) {
  const double range = 0.4 + 1.2 * stream.uniform();
  const Eigen::Vector3d ray =
      Eigen::Vector3d(stream.uniform() - 0.5, stream.uniform() - 0.5, 1.0).normalized();
  return SE3d(uniform_rotation(stream), range * ray);
}

/// A detection Y with deviations sd along the viewing ray of the mode T (rotation about its
/// origin): the error n is turned by Rodrigues' formula from z to the ray, and Y = T Exp(n in the
/// axes of T).
inline SE3d detect_along_ray(const SE3d& mode, const Vector6d& sd, RandomStream& stream) {
  const Vector6d n = normal_vector(stream).cwiseProduct(sd);
  const Eigen::Vector3d& t = mode.translation();
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ().cross(t.normalized());
  const double angle = std::atan2(axis.norm(), t.normalized().z());
  const SO3d turn = SO3d::exp(angle * axis.normalized());
  const SO3d to_mode = mode.rotation().inverse() * turn;
  Vector6d along_mode;
  along_mode << to_mode * Eigen::Vector3d(n.head<3>()),
      to_mode * Eigen::Vector3d(t.norm() * n.tail<3>());
  return mode * SE3d::exp(along_mode);
}

/// A pose that is uniform over all rotations and a cube of 1 m about the object.
inline SE3d detect_nothing(const SE3d& truth, RandomStream& stream) {
  const Eigen::Vector3d shift(stream.uniform() - 0.5, stream.uniform() - 0.5,
                              stream.uniform() - 0.5);
  return SE3d(uniform_rotation(stream), truth.translation() + shift);
}

inline Vector6d ray_deviations() {
  Vector6d sd;
  sd << radians(4.0), radians(3.5), radians(2.0), 0.008, 0.01, 0.05;
  return sd;
}

/// 70 % along the ray, 30 % clutter.
inline std::vector<NoiseObservation> detections_with_clutter(std::size_t count,
                                                             std::uint64_t seed) {
  RandomStream stream(seed);
  std::vector<NoiseObservation> observations;
  for (std::size_t i = 0; i < count; ++i) {
    const SE3d truth = pose_before_camera(stream);
    const bool clutter = stream.uniform() < 0.3;
    observations.push_back({truth, clutter ? detect_nothing(truth, stream)
                                           : detect_along_ray(truth, ray_deviations(), stream)});
  }
  return observations;
}

/// Recordings of a detector that follows ray_deviations() and reports a pose 90 degrees off in one
/// detection of seven, and clutter as often; and another wrong pose for a while in one recording.
inline std::vector<NoiseTrack> recordings_with_modes() {
  RandomStream stream(7);
  const SE3d mode(SO3d::exp({0.0, radians(90.0), 0.0}), {0.01, 0.02, 0.0});
  const SE3d run(SO3d::exp({radians(150.0), 0.0, 0.0}), {0.0, 0.0, 0.0});
  std::vector<NoiseTrack> tracks;
  for (std::size_t recording = 0; recording < 4; ++recording) {
    NoiseTrack& track = tracks.emplace_back();
    for (int i = 0; i < 600; ++i) {
      const SE3d truth = pose_before_camera(stream);
      const double u = stream.uniform();
      SE3d detected = detect_along_ray(truth, ray_deviations(), stream);
      if (u < 0.15) detected = detect_along_ray(truth * mode, ray_deviations(), stream);
      if (u > 0.85) detected = detect_nothing(truth, stream);
      if (recording == 2 && i < 200)
        detected = detect_along_ray(truth * run, ray_deviations(), stream);
      track.push_back(NoiseObservation{truth, detected, recording});
    }
  }
  return tracks;
}

}  // namespace posemix::testing
