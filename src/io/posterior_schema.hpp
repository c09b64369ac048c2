// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string_view>

#include "posemix/io/posterior_file.hpp"

/// The words of posterior.json, for writer and reader.
namespace posemix::internal {

inline constexpr std::string_view kPosteriorType = "posemix.posterior";
inline constexpr std::string_view kSide = "left";
inline constexpr std::string_view kOrder = "rotation_translation";
/// kOrder in files of the release before.
inline constexpr std::string_view kOldOrder = "rot_trans";
inline constexpr std::string_view kRotationUnit = "rad";
inline constexpr std::string_view kTranslationUnit = "m";

struct PoseKindWords {
  PoseKind kind;
  std::string_view word;
  std::string_view transform;
  std::string_view frame;  ///< frame of the covariance
};

inline constexpr std::array<PoseKindWords, 3> kPoseKinds{
    {{PoseKind::camera, "camera", "T_world_camera", "world"},
     {PoseKind::camera_motion, "camera_motion", "T_camera_camera_after_one_period", "camera"},
     {PoseKind::object, "object", "T_world_object", "world"}}};

}  // namespace posemix::internal
