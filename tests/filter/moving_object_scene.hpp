// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "posemix/filter/moving_object_filter.hpp"
#include "posemix/testing/expect.hpp"
#include "scenario.hpp"

/// An object that moves by a model before a camera, and a detector that errs in modes and runs, for
/// the tests of the filter of one moving object.
namespace posemix::testing {

inline constexpr double kFramePeriod_s = 0.1;  ///< between two frames [s]
inline const SE3d kFlipOfObject = pose(0, 0, std::numbers::pi, 0, 0, 0);

inline Vector6d sds(double rotation, double translation) {
  Vector6d all;
  all << Eigen::Vector3d::Constant(rotation), Eigen::Vector3d::Constant(translation);
  return all;
}

/// Switches off what is learned: the filter takes the noise as stated.
inline MovingObjectSettings plain_moving_settings() {
  MovingObjectSettings s;
  s.noise_scale_detections = std::numeric_limits<double>::infinity();
  return s;
}

/// Noise along the ray: an inlier of 2 degrees, 3 mm and 1 % of the range, gross errors three times
/// as large, clutter; flips as a mode of their own where `flips` is positive.
struct SceneNoise {
  double gross = 0.1;
  double clutter = 0.05;
  double flips = 0.0;
  double mode_time_s = 0.0;

  static Matrix6d inlier() {
    return pose_covariance(Eigen::Vector3d::Constant(radians(2.0)), {0.003, 0.003, 0.01});
  }
  DetectorNoise noise() const {
    std::vector<NoiseComponent> components{{.weight = 1.0 - gross - clutter - flips,
                                            .covariance = inlier(),
                                            .frame = NoiseFrame::ray}};
    if (gross > 0.0)
      components.push_back(
          {.weight = gross, .covariance = 9.0 * inlier(), .frame = NoiseFrame::ray});
    if (flips > 0.0) {
      components.push_back({.weight = flips,
                            .covariance = inlier(),
                            .frame = NoiseFrame::ray,
                            .offset = kFlipOfObject});
    }
    return DetectorNoise(components, {.weight = clutter, .volume_m3 = 1.0},
                         {.mode_time_s = mode_time_s});
  }
};

/// A camera that looks at the object from about 0.8 m.
inline SE3d scene_camera() { return {SO3d::exp({-2.2, 0.0, 0.0}), {0.0, -0.65, 0.45}}; }

class MovingScene {
 public:
  explicit MovingScene(std::uint64_t seed, DetectorNoise noise)
      : stream(seed, 11), noise_(std::move(noise)) {}

  /// Moves the object by a model over `dt` seconds, in small steps of its noise.
  void advance(const ObjectMotion& motion, double dt, const SE3d& frame_motion = {}) {
    constexpr int kSteps = 4;
    for (int k = 0; k < kSteps; ++k) {
      const MotionPrediction next = predict({truth, twist, Matrix12d::Zero()}, motion, dt / kSteps,
                                            k == 0 ? frame_motion : SE3d());
      truth = next.state.pose;
      twist = next.state.twist;
      if (next.noise.isZero(0.0)) continue;
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> root{Eigen::MatrixXd(next.noise)};
      Eigen::VectorXd white(12);
      stream.fill_normal(white);
      const Eigen::VectorXd error =
          root.eigenvectors() * root.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * white;
      truth = SE3d::exp(Vector6d(error.head<6>())) * truth;
      twist += error.tail<6>();
    }
    time_s += dt;
  }

  /// Puts the object down somewhere in a cube of 0.4 m, in any orientation, at least 0.1 m from
  /// here.
  void put_down() {
    const Eigen::Vector3d before = truth.translation();
    do {
      Eigen::VectorXd white(4);
      stream.fill_normal(white);
      const Eigen::Quaterniond turn(white[0], white[1], white[2], white[3]);
      const Eigen::Vector3d place = point_in_cube(stream);
      truth = SE3d(SO3d::from_matrix(turn.normalized().toRotationMatrix()), 0.4 * place);
    } while ((truth.translation() - before).norm() < 0.1);
  }

  /// The pose `object` as the detector's component errs.
  SE3d erring(const SE3d& object, const NoiseComponent& component) {
    const SE3d mode = camera.inverse() * object * component.offset;
    const NoiseAtPose at = noise_at(component, camera.inverse() * object);
    return at.axes * SE3d::exp(draw(at.covariance, stream)) * at.axes.inverse() * mode;
  }

  /// A detection by the noise model, one independent of the others.
  SE3d detect() {
    double chance = stream.uniform();
    for (const NoiseComponent& component : noise_.components()) {
      if (chance < component.weight) return erring(truth, component);
      chance -= component.weight;
    }
    return anywhere();
  }

  /// A detection under the first component of the noise.
  SE3d inlier() { return erring(truth, noise_.components().front()); }

  /// A wrong detection: uniform over all rotations and a cubic metre about the origin.
  SE3d anywhere() {
    Eigen::VectorXd white(4);
    stream.fill_normal(white);
    const Eigen::Quaterniond turn(white[0], white[1], white[2], white[3]);
    const Eigen::Vector3d place = point_in_cube(stream);
    return camera.inverse() * SE3d(SO3d::from_matrix(turn.normalized().toRotationMatrix()), place);
  }

  Observation observed(const SE3d& seen) const {
    Observation observation = observation_of(seen);
    observation.stamp_s = time_s;
    return observation;
  }

  RandomStream stream;
  SE3d camera = scene_camera();
  SE3d truth = pose(0.3, 0.2, 0.5, 0.02, -0.03, 0.01);
  Vector6d twist = Vector6d::Zero();
  double time_s = 0.0;

 private:
  DetectorNoise noise_;
};

/// xi^T P^-1 xi of the truth under a density.
inline double nees_of(const SE3d& truth, const ConcentratedGaussian<SE3d>& density) {
  const Vector6d z = (truth * density.mean().inverse()).log();
  return z.dot(Eigen::LLT<Matrix6d>(density.covariance()).solve(z));
}

}  // namespace posemix::testing
