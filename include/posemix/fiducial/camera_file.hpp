// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/fiducial/camera_model.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {

/// A pose as a file states it, with or without an uncertainty.
struct StatedPose {
  SE3d pose = {};  ///< T_a_b
  /// Covariance of n of T_a_b Exp(n), rotation [rad] before translation [m].
  std::optional<Matrix6d> covariance = {};
};

/// A camera of a rig.
struct RigCamera {
  std::string name = {};
  CameraModel model = {};
  std::optional<std::array<int, 2>> resolution = {};  ///< width, height [px]
  std::vector<std::string> topics = {};               ///< of its images and its corners
  std::optional<StatedPose> rig_camera = {};          ///< T_rig_camera
};

/// The cameras of a YAML file as TagSLAM (cameras.yaml) and kalibr (camchain.yaml) write it, in the
/// order of their names: `camera_model: pinhole`, `intrinsics`, `distortion_model` (equidistant,
/// radtan, none), `distortion_coeffs`; if they are there `resolution`, `rostopic`, `tagtopic` and
/// `T_cn_cnm1`, which chains the cameras: the first one's frame is then that of the rig.
/// @throws InvalidInput `name:line: key: got ..., expected ...`, and in a build without yaml-cpp
std::vector<RigCamera> parse_cameras(std::string_view text, const std::string& name);
std::vector<RigCamera> read_cameras(const std::filesystem::path& path);

/// Adds the poses T_rig_camera of TagSLAM's camera_poses.yaml: per camera `pose` with `position`,
/// `rotation` (rotation vector) and, if it is there, `R`, the 36 numbers of the square root of the
/// information (GTSAM's, rotation first): the covariance is (R^T R)^-1.
/// @throws InvalidInput as parse_cameras, also for a camera that is not among `cameras`
void parse_camera_poses(std::string_view text, const std::string& name,
                        std::vector<RigCamera>& cameras);
void read_camera_poses(const std::filesystem::path& path, std::vector<RigCamera>& cameras);

}  // namespace posemix
