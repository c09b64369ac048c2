// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <limits>
#include <numbers>
#include <vector>

#include "posemix/filter/multi_object_filter.hpp"
#include "scenario.hpp"

/// A camera that circles objects, and a detector that errs in modes, for the tests of the
/// multi-object filter.
namespace posemix::testing {

/// Switches off everything that is learned or damped for real detectors: the filter takes the noise
/// as stated, and nothing but its projections is approximate.
inline MultiObjectSettings plain_settings() {
  MultiObjectSettings s;
  s.noise_scale_detections = std::numeric_limits<double>::infinity();
  s.camera_gain = 1.0;
  s.slow_error_gain = 1.0;
  s.camera_rotation_correction = 1.0;
  s.camera_position_correction = 1.0;
  s.default_clutter = 0.0;
  return s;
}

/// Noise along the ray with a sharp component, a wide one and clutter, as in docs/many-objects.md.
inline DetectorNoise ray_noise(double clutter = 0.23) {
  const Matrix6d sharp =
      pose_covariance({radians(7.5), radians(7.5), radians(2.0)}, {0.005, 0.005, 0.06});
  return DetectorNoise({{.weight = 0.65, .covariance = sharp, .frame = NoiseFrame::ray},
                        {.weight = 0.12, .covariance = 7.29 * sharp, .frame = NoiseFrame::ray}},
                       {.weight = clutter, .volume_m3 = 1.0});
}

struct OrbitScene {
  explicit OrbitScene(std::uint64_t seed, std::size_t objects, double rotation_sd_deg,
                      double translation_sd_m)
      : stream(seed, 7), q(isotropic(rotation_sd_deg, translation_sd_m)), camera(camera_at(0)) {
    for (std::size_t j = 0; j < objects; ++j) {
      const auto place = static_cast<double>(j);
      truth.push_back(pose(0.3 * place, 0.2, 0.5 - place, 0.15 * place - 0.15, 0.1, 0.05));
    }
  }

  /// A camera that looks at the origin from a circle of one metre.
  static SE3d camera_at(int frame) {
    const double angle = 0.02 * frame;
    const SE3d turn = pose(0, 0, angle, 0, 0, 0);
    const SE3d view(SO3d::exp({-2.2, 0.0, 0.0}), {0.0, -1.0, 0.7});
    return turn * view;
  }

  /// Moves the camera and returns the next frame's odometry.
  SE3d advance() {
    const SE3d next = camera_at(++frame);
    const SE3d motion = camera.inverse() * next;
    camera = next;
    return motion * SE3d::exp(draw(q, stream));
  }

  /// A detection of the true pose, of its flip, or a gross error.
  SE3d detect(std::size_t object, double flips, double wild) {
    const SE3d seen = camera.inverse() * truth[object];
    const double chance = stream.uniform();
    if (chance < wild) {
      const Eigen::Vector3d shift = 0.1 * normals(stream);
      return SE3d(SO3d::exp(2.0 * normals(stream)), seen.translation() + shift);
    }
    const SE3d flip = pose(0, 0, std::numbers::pi, 0, 0, 0);
    const SE3d mode = chance < wild + flips ? seen * flip : seen;
    const NoiseAtPose at = noise_at(ray_noise().components().front(), mode);
    return at.axes * SE3d::exp(draw(at.covariance, stream)) * at.axes.inverse() * mode;
  }

  RandomStream stream;
  Matrix6d q;
  int frame = 0;
  SE3d camera;
  std::vector<SE3d> truth;
};

/// A filter that begins at the camera of the scene.
inline MultiObjectFilter filter_of(const OrbitScene& scene, const MultiObjectSettings& settings,
                                   const SymmetryGroup& symmetries = {}, double clutter = 0.23) {
  std::vector<ObjectSensor> sensors(scene.truth.size(), {ray_noise(clutter), symmetries});
  return {ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)), sensors, settings};
}

/// The hypotheses of an object as a mixture over its pose in the world.
inline Mixture<ConcentratedGaussian<SE3d>> world_mixture(const MultiObjectFilter& filter,
                                                         std::size_t object) {
  std::vector<Component<ConcentratedGaussian<SE3d>>> components;
  for (const ObjectHypothesis& h : filter.hypotheses(object))
    components.push_back({h.log_weight, {h.pose, h.covariance}});
  return Mixture<ConcentratedGaussian<SE3d>>(std::move(components));
}

}  // namespace posemix::testing
