// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/slam/symmetric_error.hpp"
#include "study.hpp"

namespace posemix {

struct FuseViewsErrors {
  double rotation_deg;
  double translation_m;
  double mssd_m;
  double mssd_recall;  ///< share of BOP's thresholds, 5 % to 50 % of the diameter, that are kept

  bool within(double deg, double metres) const {
    return rotation_deg <= deg && translation_m <= metres;
  }
};

/// Errors against the nearest equivalent of the truth, for objects of one dataset.
class FuseViewsMetric {
 public:
  explicit FuseViewsMetric(const FuseViewsObjects& objects, double match_m)
      : objects_(objects), match_m_(match_m) {}

  const SymmetryGroup& symmetries(std::int64_t object) const {
    static const SymmetryGroup kNone;
    const auto group = objects_.symmetries.find(object);
    return group == objects_.symmetries.end() ? kNone : group->second;
  }
  FuseViewsErrors errors(std::int64_t object, const SE3d& estimate, const SE3d& truth) const {
    static const ObjectBox kCube{Eigen::Vector3d::Constant(-0.05), Eigen::Vector3d::Constant(0.1)};
    const auto known = objects_.boxes.find(object);
    const ObjectBox& box = known == objects_.boxes.end() ? kCube : known->second;
    const SymmetryGroup& group = symmetries(object);
    const SymmetricPoseError error = symmetric_pose_error(estimate, truth, group);
    const double mssd = max_symmetric_surface_distance(estimate, truth, box.corners(), group);
    int kept = 0;
    for (int i = 1; i <= 10; ++i) kept += mssd < 0.05 * i * box.size_m.norm() ? 1 : 0;
    return {degrees(error.rotation_rad), error.translation_m, mssd, 0.1 * kept};
  }
  /// Index of the pose nearest to the true one; empty where none is near.
  std::optional<std::size_t> nearest(const std::vector<SE3d>& poses, const SE3d& truth) const {
    std::optional<std::size_t> best;
    double least = match_m_;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double distance = (poses[i].translation() - truth.translation()).norm();
      if (distance > least) continue;
      least = distance;
      best = i;
    }
    return best;
  }

 private:
  const FuseViewsObjects& objects_;
  double match_m_;
};

}  // namespace posemix
