// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <limits>

#include "filter/precision.hpp"
#include "filter/world_shift.hpp"
#include "invariants.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/observation.hpp"

namespace posemix::fuzzing {

/// Covariances are definite while no pose is known so much worse than a detector sees it that
/// double precision holds nothing of the detection beside it, about any place that counts: its own,
/// that of the camera and the origin of the world. What is left beyond is finite
/// (docs/filter-consistency.md, "Definite, or finite").
class Precision {
 public:
  /// Beyond this ratio of variances, and this standard deviation of a rotation [rad], nothing is
  /// promised but finite numbers.
  explicit Precision(double largest_ratio,
                     double widest_rotation = std::numeric_limits<double>::infinity())
      : largest_ratio_(largest_ratio), widest_rotation_(widest_rotation) {}

  /// What a detector sees [rad^2, m^2], in its sharpest direction: correlations may leave less of a
  /// variance than the diagonal says.
  void see(const Matrix6d& noise) {
    const double left = std::max(least_correlation(noise), std::numeric_limits<double>::min());
    for (const int at : {0, 3}) {
      const auto variances = noise.diagonal().segment<3>(at);
      finest_[at] = std::min(finest_[at], left * variances.minCoeff());
      widest_[at] = std::max(widest_[at], variances.maxCoeff());
    }
  }
  void see(const DetectorNoise& noise) {
    for (const NoiseComponent& component : noise.components()) {
      see(component.covariance);
      swing(component.covariance, component.offset.translation().norm());
    }
  }
  /// A detection at a distance [m], by which its rotation moves what is seen.
  void see(const DetectorNoise& noise, double distance) {
    see(noise);
    for (const NoiseComponent& component : noise.components())
      swing(component.covariance, distance);
  }
  void see(const Observation& observation) {
    for (const ObservationComponent& component : observation.components)
      if (component.covariance) see(*component.covariance);
  }
  /// A rotation moves what is at a distance [m].
  void swing(const Matrix6d& noise, double lever) {
    widest_[3] = std::max(widest_[3], lever * lever * noise.diagonal().head<3>().maxCoeff());
  }

  /// The camera is here when something is detected.
  void move_to(const Eigen::Vector3d& camera) {
    camera_ = camera;
    is_far_ = is_far_ || camera.norm() > internal::kFarFromOrigin_m;
  }
  /// A covariance in the world, before a detection.
  void widen(const Matrix6d& covariance) { widen(camera_, covariance); }
  /// The same about the pose itself and the origin of the world.
  void widen_at(const SE3d& pose, const Matrix6d& covariance) {
    widen(pose.translation(), covariance);
    widen(Eigen::Vector3d::Zero(), covariance);
  }
  bool is_left() const {
    return widest_[0] <= widest_rotation_ * widest_rotation_ &&
           ratio() <= (is_far_ ? std::min(kLargestRatioFar, largest_ratio_) : largest_ratio_);
  }
  /// What rounding beside the widest variance may do to correlations of the finest.
  double rounding() const {
    return kRounding + 64.0 * std::numeric_limits<double>::epsilon() * ratio();
  }

 private:
  /// Where the origin of the filter's world was not that of the caller's.
  static constexpr double kLargestRatioFar = 1e10;

  double ratio() const { return std::max(widest_[0] / finest_[0], widest_[3] / finest_[3]); }
  void widen(const Eigen::Vector3d& place, const Matrix6d& covariance) {
    const Matrix6d there = SE3d(SO3d(), -place).adjoint_congruence(covariance);
    for (const int at : {0, 3})
      widest_[at] = std::max(widest_[at], there.diagonal().segment<3>(at).maxCoeff());
  }

  double largest_ratio_;
  double widest_rotation_;
  Vector6d widest_ = Vector6d::Zero();
  Vector6d finest_ = Vector6d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d camera_ = Eigen::Vector3d::Zero();
  bool is_far_ = false;
};

}  // namespace posemix::fuzzing
