// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "posemix/fiducial/corner_file.hpp"
#include "posemix/fiducial/tag_file.hpp"
#include "posemix/fiducial/tag_pose.hpp"
#include "posemix/testing/mutate.hpp"

/// Damaged files of corners, cameras and tags are read or refused, whatever the damage.
namespace posemix {
namespace {

constexpr std::size_t kInputs = 5000;

void expect_sound(const testing::FuzzReport& report) {
  EXPECT_TRUE(report.failures.empty())
      << report.failures.size() << " failures, the first: " << report.failures[0];
  EXPECT_GT(report.accepted, 50U);
  EXPECT_GT(report.rejected, 50U);
}

TEST(DamagedFiles, Corners) {
  const std::vector<std::string> originals{
      "stamp_s,topic,tag,u0_px,v0_px,u1_px,v1_px,u2_px,v2_px,u3_px,v3_px\n"
      "1.5,/tags,7,500.2,300.1,531.5,301.9,532.3,270.4,500.9,268.8\n"
      "1.6,/tags,7,640.3,520.2,648.9,528.4,650.1,479.5,641.0,473.2\n"};
  const CameraModel camera{.intrinsics = {600.0, 602.0, 640.0, 512.0},
                           .distortion = DistortionModel::equidistant,
                           .coefficients = {-0.013, -0.0099, 0.0121, -0.0045}};
  const auto parse = [&](const std::string& text) {
    for (const CornerSighting& sighting : parse_corners(text, "c.csv")) {
      Observation observation;
      observation.components =
          tag_components(tag_minima(sighting.corners, 0.15, camera), {.sd_px = 0.3, .dof = 3.0});
      if (!observation.components.empty()) validate(observation);
    }
  };
  expect_sound(testing::fuzz(originals, kInputs, 41, parse));
}

#ifdef POSEMIX_WITH_YAML

TEST(DamagedFiles, Cameras) {
  const std::vector<std::string> originals{
      "cam0:\n  camera_model: pinhole\n  intrinsics: [500, 501, 320, 240]\n"
      "  distortion_model: equidistant\n  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n"
      "  resolution: [640, 480]\n  tagtopic: /left/tags\n"
      "cam1:\n  intrinsics: [500, 501, 320, 240]\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.2]\n"
      "  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n"};
  const auto parse = [](const std::string& text) {
    for (const RigCamera& camera : parse_cameras(text, "cameras.yaml")) validate(camera.model);
  };
  expect_sound(testing::fuzz(originals, kInputs, 42, parse));
}

TEST(DamagedFiles, Tags) {
  const std::vector<std::string> originals{
      "default_body: wall\nbodies:\n - wall:\n     is_static: true\n     default_tag_size: 0.15\n"
      "     ignore_tags: [20, 24]\n     pose:\n       position: {x: 0, y: 0, z: 1}\n"
      "       rotation: {x: 0, y: 0, z: 0}\n     tags:\n       - id: 3\n         size: 0.2\n"
      "         pose:\n           position: {x: 2, y: 0, z: 0}\n"
      "           rotation: {x: 0, y: 0, z: 0}\n"
      "           position_noise: {x: 0.03, y: 0.04, z: 0.05}\n"
      "           rotation_noise: {x: 0.001, y: 0.001, z: 0.001}\n"};
  const auto parse = [](const std::string& text) { parse_tag_map(text, "tagslam.yaml"); };
  expect_sound(testing::fuzz(originals, kInputs, 43, parse));
}

#endif

}  // namespace
}  // namespace posemix
