// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include "posemix/filter/update.hpp"

namespace posemix::internal {

/// The innovations of several detections under one or more noises, all at once by vector
/// instructions; innovation() is the reference.
struct Innovations {
  Eigen::VectorXd residual;     ///< z, six coordinates for every component
  std::vector<Matrix6d> noise;  ///< R, by component

  /// `components` are by noise, then by detection.
  void set(const PoseStackd& mean, std::span<const Detection> detections,
           std::span<const NoiseComponent* const> components);

 private:
  std::vector<SE3d> detected_;
  std::vector<SE3d> objects_;
  std::vector<SE3d> axes_;
};

}  // namespace posemix::internal
