// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>

#include "study.hpp"

namespace posemix {

/// Errors of one pose against the nearest equivalent of the true pose.
struct TlessErrors {
  double rotation_deg = 0.0;
  double translation_m = 0.0;
  double mssd_m = 0.0;
  bool is_within = false;  ///< 20 deg and 5 cm
};

/// Errors by class of object.
class TlessMetric {
 public:
  explicit TlessMetric(const TlessStudySettings& settings) : settings_(settings) {}

  const SymmetryGroup& symmetries(const std::string& class_id) const;
  TlessErrors errors(const std::string& class_id, const SE3d& estimate, const SE3d& truth) const;
  /// The errors of the pose that is nearest to the true one; empty where none is within the
  /// settings' `match_m`.
  std::optional<TlessErrors> nearest(const std::string& class_id, std::span<const SE3d> poses,
                                     const SE3d& truth) const;

 private:
  const TlessStudySettings& settings_;
};

}  // namespace posemix
