// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "scene_frame.hpp"

#include "posemix/lie/pose_blocks.hpp"

namespace posemix::internal {
namespace {

/// Nearer to the origin [m], all digits that are asked for are there, and every round trip costs
/// some.
constexpr double kFar_m = 1000.0;

}  // namespace

std::optional<Eigen::Vector3d> scene_origin(const Posterior& posterior) {
  const Eigen::Vector3d& camera = posterior[0].density.mean()[kCamera].translation();
  if (camera.norm() < kFar_m) return std::nullopt;
  return camera;
}

void move_world(const WorldShift& shift, std::size_t first_object,
                std::vector<Component<Hypothesis>>& hypotheses) {
  for (Component<Hypothesis>& hypothesis : hypotheses) {
    auto [mean, covariance] = std::move(hypothesis.density).release();
    std::vector<SE3d> poses = mean.poses();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (i > kCamera && i < first_object) continue;
      poses[i] = shift(poses[i]);
      shift.move_rows(rows(covariance, i));
      shift.move_columns(columns(covariance, i));
    }
    symmetrize(covariance);
    hypothesis.density = Hypothesis::trusted(PoseStackd(std::move(poses)), std::move(covariance));
  }
}

}  // namespace posemix::internal
