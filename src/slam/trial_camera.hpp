// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/slam/object_model.hpp"

namespace posemix::internal {

/// A camera of a tracker that is made to see whether models are valid: beside the first that is
/// known, so that nothing is refused for where the camera of the session is.
inline ConcentratedGaussian<SE3d> trial_camera(const std::vector<ObjectModel>& models) {
  const auto known = std::find_if(models.begin(), models.end(),
                                  [](const ObjectModel& model) { return model.prior.has_value(); });
  const Eigen::Vector3d place = known == models.end() ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                                      : known->prior->world.mean().translation();
  const SE3d pose(SO3d(), place);
  return {pose, pose.adjoint_congruence(Matrix6d(1e-6 * Matrix6d::Identity()))};
}

}  // namespace posemix::internal
