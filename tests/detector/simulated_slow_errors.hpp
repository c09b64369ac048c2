// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "simulated_detections.hpp"

/// Recordings of a detector with white, slow and common errors, drawn by their definition.
namespace posemix::testing {

struct SlowSimulation {
  Vector6d white_sd = Vector6d::Zero();                        ///< along the object's axes [rad, m]
  Vector6d slow_sd = Vector6d::Zero();                         ///< likewise
  Vector6d common_sd = Vector6d::Zero();                       ///< likewise, one draw per recording
  double angle_rad = std::numeric_limits<double>::infinity();  ///< of the slow error's correlation
  double time_s = std::numeric_limits<double>::infinity();
  bool along_ray = false;  ///< white and slow errors are along the viewing ray, as NoiseFrame::ray
  std::size_t recordings = 12;
  std::size_t frames = 150;
  double detected = 0.8;  ///< probability
  double gross = 0.0;     ///< probability that a run of clutter begins with a detection
  double gross_frames = 20.0;
};

/// A camera that circles an object at 0.5 s per frame: 4 degrees per frame about the object's z
/// axis, up and down by 30 degrees, 0.6 to 1.4 m away.
inline SE3d circling_truth(std::size_t frame, double phase) {
  const double k = static_cast<double>(frame);
  const double azimuth = phase + radians(4.0) * k;
  const double elevation = radians(30.0) * std::sin(0.05 * k + phase);
  const Eigen::Vector3d view(std::cos(elevation) * std::cos(azimuth),
                             std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  const double range = 1.0 + 0.4 * std::sin(0.03 * k + 2.0 * phase);
  const Eigen::Vector3d z = -view;
  const Eigen::Vector3d x = Eigen::Vector3d::UnitZ().cross(z).normalized();
  Eigen::Matrix3d object_camera;
  object_camera << x, z.cross(x), z;
  return SE3d(SO3d::from_matrix(object_camera), range * view).inverse();
}

inline double angle_between_views(const SE3d& a, const SE3d& b) {
  const Eigen::Vector3d u = a.inverse().translation().normalized();
  const Eigen::Vector3d v = b.inverse().translation().normalized();
  return std::acos(std::min(1.0, u.dot(v)));
}

/// The truth and the detections of one recording. The camera looks at the object, so that the axes
/// of the viewing ray are those of the camera.
struct SlowRecording {
  std::vector<std::optional<SE3d>> truth;
  std::vector<std::optional<SE3d>> detected;
  std::vector<double> stamps_s;
};

inline SlowRecording slow_recording(const SlowSimulation& s, RandomStream& stream) {
  SlowRecording result;
  const double phase = 2.0 * std::numbers::pi * stream.uniform();
  const Vector6d common = normal_vector(stream).cwiseProduct(s.common_sd);
  Vector6d slow = normal_vector(stream).cwiseProduct(s.slow_sd);
  std::size_t gross = 0;
  for (std::size_t frame = 0; frame < s.frames; ++frame) {
    const SE3d truth = circling_truth(frame, phase);
    if (frame > 0) {
      const double a = std::exp(-angle_between_views(*result.truth.back(), truth) / s.angle_rad -
                                0.5 / s.time_s);
      slow = a * slow + std::sqrt(1.0 - a * a) * normal_vector(stream).cwiseProduct(s.slow_sd);
    }
    result.stamps_s.push_back(0.5 * static_cast<double>(frame));
    result.truth.emplace_back(truth);
    Vector6d error = slow + normal_vector(stream).cwiseProduct(s.white_sd);
    if (s.along_ray) {
      const SO3d to_object = truth.rotation().inverse();
      Vector6d along_object;
      along_object << to_object * Eigen::Vector3d(error.head<3>()),
          to_object * Eigen::Vector3d(truth.translation().norm() * error.tail<3>());
      error = along_object;
    }
    const bool seen = stream.uniform() < s.detected;
    if (gross > 0) --gross;
    if (gross == 0 && stream.uniform() < s.gross)
      gross = static_cast<std::size_t>(-s.gross_frames * std::log(stream.uniform())) + 1;
    const SE3d nothing = detect_nothing(truth, stream);
    const SE3d detection = gross > 0 ? nothing : truth * SE3d::exp(Vector6d(error + common));
    result.detected.push_back(seen ? std::optional(detection) : std::nullopt);
  }
  return result;
}

inline std::vector<NoiseTrack> slow_recordings(const SlowSimulation& simulation,
                                               std::uint64_t seed) {
  RandomStream stream(seed);
  std::vector<NoiseTrack> tracks;
  for (std::size_t r = 0; r < simulation.recordings; ++r) {
    const SlowRecording recording = slow_recording(simulation, stream);
    tracks.push_back(noise_track(recording.truth, recording.detected, r, recording.stamps_s));
  }
  return tracks;
}

}  // namespace posemix::testing
