// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "metric.hpp"

#include <string>

#include "posemix/base/units.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/slam/symmetric_error.hpp"

namespace posemix {
namespace {

constexpr double kWithinDeg = 20.0;
constexpr double kWithinM = 0.05;

/// A proxy for the surface of an object without a model.
std::array<Eigen::Vector3d, 8> cube() {
  return ObjectBox{Eigen::Vector3d::Constant(-0.05), Eigen::Vector3d::Constant(0.1)}.corners();
}

}  // namespace

const SymmetryGroup& TlessMetric::symmetries(const std::string& class_id) const {
  static const SymmetryGroup kNone;
  const auto group = settings_.symmetries.find(std::stoll(class_id));
  return group == settings_.symmetries.end() ? kNone : group->second;
}

TlessErrors TlessMetric::errors(const std::string& class_id, const SE3d& estimate,
                                const SE3d& truth) const {
  static const auto kCube = cube();
  const SymmetryGroup& group = symmetries(class_id);
  const SymmetricPoseError error = symmetric_pose_error(estimate, truth, group);
  const auto corners = settings_.corners.find(std::stoll(class_id));
  const auto& points = corners == settings_.corners.end() ? kCube : corners->second;
  TlessErrors result{.rotation_deg = degrees(error.rotation_rad),
                     .translation_m = error.translation_m,
                     .mssd_m = max_symmetric_surface_distance(estimate, truth, points, group)};
  result.is_within = result.rotation_deg <= kWithinDeg && result.translation_m <= kWithinM;
  return result;
}

std::optional<TlessErrors> TlessMetric::nearest(const std::string& class_id,
                                                std::span<const SE3d> poses,
                                                const SE3d& truth) const {
  const SE3d* best = nullptr;
  double least = settings_.match_m;
  for (const SE3d& pose : poses) {
    const double distance = (pose.translation() - truth.translation()).norm();
    if (distance > least) continue;
    least = distance;
    best = &pose;
  }
  return best == nullptr ? std::nullopt : std::optional(errors(class_id, *best, truth));
}

}  // namespace posemix
