// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "posemix/slam/run.hpp"
#include "scene.hpp"
#include "study.hpp"

/// What the sources of `study tless` share.
namespace posemix {

/// Errors of one pose against the nearest equivalent of the truth.
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
  /// Of the poses that are within the settings' `match_m` of the truth that which is nearest; its
  /// errors.
  std::optional<TlessErrors> nearest(const std::string& class_id, std::span<const SE3d> poses,
                                     const SE3d& truth) const;

 private:
  const TlessStudySettings& settings_;
};

/// One scene with or without declared symmetries: {"instances": [...], "scene": {...}}, rows of
/// named numbers.
nlohmann::ordered_json run_tless(const TlessScene& scene, const TlessStudySettings& settings,
                                 bool declared);

StudyReport report_tless(std::span<const std::string> results);

/// The scene with synthetic odometry: the true motion of the camera with noise.
Sequence with_synthetic_odometry(const TlessScene& scene, const TlessStudySettings& settings);

}  // namespace posemix
