// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fiducial/views.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/io/gzip.hpp"
#include "posemix/io/tum.hpp"

/// Files of a simulated recording of square tags.
namespace posemix::testing {

inline constexpr int kTagFrames = 60;
inline constexpr double kTagEdge = 0.15;

/// T_map_rig: a curve before a wall of tags, looking at it.
inline SE3d rig_at(double t) {
  return {SO3d::exp({0.02 * std::sin(3.0 * t), 0.2 * std::sin(t), 0.05 * std::sin(2.0 * t)}),
          {1.0 * std::sin(2.0 * t), 0.3 * std::sin(2.0 * t), 0.2 * std::cos(t)}};
}

/// T_map_tag of a tag that looks back at the rig, turned about the vertical axis.
inline SE3d tag_pose(int tag) {
  const double turn = tag % 2 == 0 ? 0.5 : -0.5;
  return {SO3d::exp({0.0, turn, 0.0}) * SO3d::exp({std::numbers::pi, 0.0, 0.0}),
          {0.6 * tag - 1.2, 0.25 * (tag % 3) - 0.25, 2.5}};
}

inline std::string rotation_text(const SO3d& rotation) {
  const Eigen::Vector3d v = rotation.log();
  return fmt::format("{{x: {}, y: {}, z: {}}}", v.x(), v.y(), v.z());
}

inline std::string position_text(const Eigen::Vector3d& p) {
  return fmt::format("{{x: {}, y: {}, z: {}}}", p.x(), p.y(), p.z());
}

/// TagSLAM's tagslam.yaml with the surveyed poses of the first tags.
inline std::string tags_text(int surveyed) {
  std::string text =
      "default_body: wall\n"
      "bodies:\n"
      " - wall:\n"
      "     is_static: true\n"
      "     default_tag_size: 0.15\n"
      "     pose:\n"
      "       position: {x: 0, y: 0, z: 0}\n"
      "       rotation: {x: 0, y: 0, z: 0}\n"
      "       position_noise: {x: 0.001, y: 0.001, z: 0.001}\n"
      "       rotation_noise: {x: 0.001, y: 0.001, z: 0.001}\n"
      "     type: simple\n"
      "     tags:\n";
  for (int tag = 0; tag < surveyed; ++tag) {
    text += fmt::format(
        "       - id: {}\n         size: 0.15\n         pose:\n"
        "           position: {}\n           rotation: {}\n"
        "           position_noise: {{x: 0.002, y: 0.002, z: 0.002}}\n"
        "           rotation_noise: {{x: 0.005, y: 0.005, z: 0.005}}\n",
        tag, position_text(tag_pose(tag).translation()), rotation_text(tag_pose(tag).rotation()));
  }
  return text;
}

inline constexpr const char* kCameras =
    "cam0:\n"
    "  camera_model: pinhole\n"
    "  intrinsics: [600.0, 602.0, 640.0, 512.0]\n"
    "  distortion_model: radtan\n"
    "  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n"
    "  resolution: [1280, 1024]\n"
    "  tagtopic: /tags\n";

/// Writes a recording with corner noise of a third of a pixel.
inline void write_recording(const TemporaryFolder& data, const std::string& name, bool has_odometry,
                            int surveyed) {
  CameraModel camera = radtan_camera();
  camera.coefficients = {0.0, 0.0, 0.0, 0.0};
  RandomStream stream(5);
  std::string corners = "stamp_s,topic,tag,u0_px,v0_px,u1_px,v1_px,u2_px,v2_px,u3_px,v3_px\n";
  std::vector<StampedPose> reference, odometry;
  const SE3d odom_map(SO3d::exp({0.3, 0.1, 0.2}), {1.0, -2.0, 0.5});
  for (int k = 0; k < kTagFrames; ++k) {
    const double t = k / 20.0;
    const SE3d rig = rig_at(t);
    reference.push_back({t, rig});
    odometry.push_back({t, odom_map * rig * SE3d(SO3d(), {0.02 * t, 0.0, 0.0})});
    for (int tag = 0; tag < 5; ++tag) {
      const TagCorners image =
          with_noise(image_of(rig.inverse() * tag_pose(tag), camera, kTagEdge), 0.3, stream);
      corners += fmt::format("{},/tags,{}", t, tag);
      for (const Eigen::Vector2d& corner : image)
        corners += fmt::format(",{:.4f},{:.4f}", corner.x(), corner.y());
      corners += "\n";
    }
  }
  data.put("tagslam/" + name + "/corners.csv.gz", gzip(corners));
  data.put("tagslam/" + name + "/cameras.yaml", kCameras);
  data.put("tagslam/" + name + "/tagslam.yaml", tags_text(surveyed));
  data.put("tagslam/" + name + "/reference_rig.tum", format_tum(reference));
  if (has_odometry) data.put("tagslam/" + name + "/odometry.tum", format_tum(odometry));
}

}  // namespace posemix::testing
