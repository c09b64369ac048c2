// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "study/recordings/recordings.hpp"

namespace posemix {

/// The metric of the published table of slam-super-6d: the median over frames and nine points (the
/// corners and the centre of the object's cuboid) of the distance in the image between estimate and
/// truth [px], infinite for a point behind the camera.
class PixelMetric {
 public:
  /// The metric for a recording. Empty where the data folder lacks intrinsics
  /// (experiments/ycbv/odom/YCB.yaml, from sequence 0060 on YCB2.yaml) or the object's cuboid
  /// (experiments/ycbv/_ycb_original.json).
  /// @throws InvalidInput for a file that is not valid
  static std::optional<PixelMetric> find(const Recording& recording);

  /// The median over pairs of estimated and true T_camera_object; empty for no pair.
  std::optional<double> median(std::span<const std::pair<SE3d, SE3d>> poses) const;

 private:
  double distance(const SE3d& estimate, const SE3d& truth, const Eigen::Vector3d& point) const;

  Eigen::Vector2d focal_;
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace posemix
