// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/fiducial/corner_file.hpp"
#include "posemix/fiducial/tag_file.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

constexpr const char* kCornerHeader =
    "stamp_s,topic,tag,u0_px,v0_px,u1_px,v1_px,u2_px,v2_px,u3_px,v3_px\n";

constexpr const char* kCameras = R"(cam1:
  camera_model: pinhole
  intrinsics: [600.0, 601.0, 640.0, 512.0]
  distortion_model: radtan
  distortion_coeffs: [-0.1, 0.01, 0.001, 0.002]
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.2]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
cam0:
  camera_model: pinhole
  intrinsics: [500, 501, 320, 240]
  distortion_model: equidistant
  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]
  resolution: [640, 480]
  rostopic: /left/image
  tagtopic: /left/tags
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error(from);
  return text.replace(at, from.size(), to);
}

TEST(CornerFile, HasARowPerTagAndImage) {
  const auto rows =
      parse_corners(std::string(kCornerHeader) + "1.5,/left/tags,7,1,2,3,4,5,6,7,8\n", "c.csv");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].stamp_s, 1.5);
  EXPECT_EQ(rows[0].topic, "/left/tags");
  EXPECT_EQ(rows[0].tag, 7);
  EXPECT_EQ(rows[0].corners[2], Eigen::Vector2d(5.0, 6.0));
  EXPECT_EQ(rows[0].place, "c.csv:2");
}

TEST(CornerFile, RefusesWhatIsNone) {
  const std::string header = kCornerHeader;
  EXPECT_INVALID(parse_corners(header, "c.csv"), "c.csv: got no rows, expected at least one");
  EXPECT_INVALID_WITH(parse_corners(header + "1,a,7,1,2,3,4,5,6,7,nan\n", "c.csv"), "c.csv:2: ");
  EXPECT_INVALID_WITH(parse_corners(header + "1,a,7,1,2,3,4,5,6,7\n", "c.csv"),
                      "c.csv:2: got 10 columns, expected 11");
  EXPECT_INVALID_WITH(parse_corners(header + "1,a,-7,1,2,3,4,5,6,7,8\n", "c.csv"), "c.csv:2: ");
  EXPECT_INVALID_WITH(parse_corners("stamp_s,topic,tag\n", "c.csv"), "no column u0_px");
}

#ifdef POSEMIX_WITH_YAML

TEST(CameraFile, HasTheCamerasOfKalibrAndTagSlam) {
  const auto cameras = parse_cameras(kCameras, "cameras.yaml");
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].name, "cam0");
  EXPECT_EQ(cameras[0].model.distortion, DistortionModel::equidistant);
  EXPECT_EQ(cameras[0].model.intrinsics, Eigen::Vector4d(500.0, 501.0, 320.0, 240.0));
  EXPECT_EQ(cameras[0].model.coefficients, (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
  EXPECT_EQ(cameras[0].topics, (std::vector<std::string>{"/left/tags", "/left/image"}));
  EXPECT_EQ(cameras[0].resolution, (std::array<int, 2>{640, 480}));
  EXPECT_EQ(cameras[1].model.distortion, DistortionModel::radtan);
  // A point at the origin of cam0 is at -0.2 m in cam1, so cam1 is at 0.2 m in cam0.
  ASSERT_TRUE(cameras[1].rig_camera.has_value());
  EXPECT_EQ(cameras[1].rig_camera->pose.translation().x(), 0.2);
  EXPECT_FALSE(cameras[1].rig_camera->covariance.has_value());
}

TEST(CameraFile, RefusesWhatIsNone) {
  const auto with = [](const std::string& from, const std::string& to) {
    return parse_cameras(replaced(kCameras, from, to), "cameras.yaml");
  };
  EXPECT_INVALID(with("601.0", "wide"),
                 "cameras.yaml:3: cam1.intrinsics[1]: got \"wide\", expected a finite number");
  EXPECT_INVALID(
      with("radtan", "omni"),
      "cameras.yaml:4: cam1.distortion_model: got \"omni\", expected equidistant, radtan "
      "or none");
  EXPECT_INVALID(with("pinhole", "omni"),
                 "cameras.yaml:2: cam1.camera_model: got \"omni\", expected pinhole");
  EXPECT_INVALID_WITH(with("0.2, 0.3, 0.4", "0.2, 0.3"), "got 3 coefficients of the distortion");
  EXPECT_INVALID_WITH(with("intrinsics: [500", "intrinsic: [500"),
                      "cam0: got no key \"intrinsics\", expected one of that name");
  EXPECT_INVALID_WITH(with("[1.0, 0.0, 0.0, -0.2]", "[2.0, 0.0, 0.0, -0.2]"),
                      "cam1.T_cn_cnm1: rotation matrix is not orthonormal");
  EXPECT_INVALID_WITH(with("[500, 501, 320, 240]", "[500, 501, 320, 240"), "cameras.yaml:");
  EXPECT_INVALID_WITH(with("[640, 480]", "[640, 1e30]"), "cam0.resolution[1]: got \"1e30\"");
  EXPECT_INVALID_WITH(with("[640, 480]", "[0, 480]"), "cam0.resolution[0]: got 0, expected pixels");
  EXPECT_INVALID_WITH(parse_cameras("- 1\n", "cameras.yaml"),
                      "cameras.yaml:1: got a list, expected a map");
  EXPECT_INVALID_WITH(parse_cameras("", "cameras.yaml"), "expected a map");
}

TEST(CameraFile, PosesOnTheRigHaveTheCovarianceOfTheirRoot) {
  auto cameras = parse_cameras(kCameras, "cameras.yaml");
  std::string root = "[";
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j)
      root += (i + j == 0 ? "" : ", ") + std::string(i == j ? (i < 3 ? "100.0" : "20.0") : "0.0");
  }
  root += "]";
  const std::string poses =
      "cam0:\n  pose:\n    position: {x: 1, y: 2, z: 3}\n    rotation: {x: 0, y: 0, z: 0.5}\n    "
      "R: " +
      root + "\n";
  parse_camera_poses(poses, "poses.yaml", cameras);
  const StatedPose& stated = cameras[0].rig_camera.value();
  EXPECT_TRUE(stated.pose.is_approx(SE3d(SO3d::exp({0.0, 0.0, 0.5}), {1.0, 2.0, 3.0}), 1e-14));
  EXPECT_NEAR((*stated.covariance)(0, 0), 1e-4, 1e-15);
  EXPECT_NEAR((*stated.covariance)(5, 5), 1.0 / 400.0, 1e-15);
  EXPECT_INVALID_WITH(parse_camera_poses(replaced(poses, "cam0", "cam7"), "poses.yaml", cameras),
                      "poses.yaml:2: cam7: got camera \"cam7\", expected one with intrinsics");
  EXPECT_INVALID_WITH(
      parse_camera_poses(replaced(poses, "[100.0,", "[0.0,"), "poses.yaml", cameras),
      "cam0.pose.R: got a matrix without an inverse");
}

constexpr const char* kTags = R"(default_body: wall
bodies:
 - wall:
     is_static: true
     default_tag_size: 0.15
     ignore_tags: [20, 24]
     pose:
       position: {x: 0, y: 0, z: 1}
       rotation: {x: 0, y: 0, z: 0}
       position_noise: {x: 0.01, y: 0.01, z: 0.01}
       rotation_noise: {x: 0.002, y: 0.002, z: 0.002}
     tags:
       - id: 3
         size: 0.2
         pose:
           position: {x: 2, y: 0, z: 0}
           rotation: {x: 0, y: 0, z: 0}
           position_noise: {x: 0.03, y: 0.04, z: 0.05}
           rotation_noise: {x: 0.001, y: 0.001, z: 0.001}
       - id: 4
 - cart:
     is_static: false
     default_tag_size: 0.1
     tags:
       - id: 8
)";

TEST(TagFile, HasSizesAndPriors) {
  const TagMap map = parse_tag_map(kTags, "tagslam.yaml");
  EXPECT_EQ(map.size_of(3), 0.2);
  EXPECT_EQ(map.size_of(4), 0.15);
  EXPECT_EQ(map.size_of(8), 0.1);
  EXPECT_EQ(map.size_of(99), 0.15);
  EXPECT_EQ(map.ignored, (std::set<std::int64_t>{20, 24}));
  ASSERT_EQ(map.priors.size(), 1U);
  const StatedPose& prior = map.priors.at(3);
  EXPECT_EQ(prior.pose.translation(), Eigen::Vector3d(2.0, 0.0, 1.0));
  // The wall's rotation moves the tag, 2 m from its origin, along y and z.
  EXPECT_NEAR((*prior.covariance)(0, 0), 5e-6, 1e-15);
  EXPECT_NEAR((*prior.covariance)(3, 3), 1e-4 + 9e-4, 1e-12);
  EXPECT_NEAR((*prior.covariance)(4, 4), 1e-4 + 16e-4 + 4.0 * 4e-6, 1e-12);
}

TEST(TagFile, HasOdometryRemapsAndNoiseOfAllTags) {
  std::string text = replaced(kTags, "is_static: true",
                              "is_static: true\n     override_tag_position_noise: 0.1\n"
                              "     override_tag_rotation_noise: 0.05");
  text = replaced(text, "is_static: false",
                  "is_static: false\n     T_body_odom:\n       position: {x: 0.1, y: 0, z: 0}\n"
                  "       rotation: {x: 0, y: 0, z: 3}");
  text +=
      "tag_id_remap:\n  - id: 20\n    remaps:\n"
      "      - remap_id: 420\n        start_time: 10.5\n        end_time: 11.5\n";
  const TagMap map = parse_tag_map(text, "tagslam.yaml");
  ASSERT_TRUE(map.rig_odometry.has_value());
  EXPECT_EQ(map.rig_odometry->translation().x(), 0.1);
  EXPECT_NEAR((*map.priors.at(3).covariance)(0, 0), 0.0025 + 4e-6, 1e-12);
  EXPECT_NEAR((*map.priors.at(3).covariance)(3, 3), 0.01 + 1e-4, 1e-9);
  EXPECT_EQ(map.tag_at(20, 10.0), 20);
  EXPECT_EQ(map.tag_at(20, 11.0), 420);
  EXPECT_EQ(map.tag_at(21, 11.0), 21);
  EXPECT_INVALID_WITH(parse_tag_map(replaced(text, "override_tag_rotation_noise: 0.05",
                                             "override_tag_rotation_noise: 0"),
                                    "tagslam.yaml"),
                      "expected a standard deviation above zero");
}

TEST(TagFile, RefusesWhatIsNone) {
  const auto with = [](const std::string& from, const std::string& to) {
    return parse_tag_map(replaced(kTags, from, to), "tagslam.yaml");
  };
  EXPECT_INVALID(with("size: 0.2", "size: -1"),
                 "tagslam.yaml:14: bodies[0].wall.tags[0].size: got -1, expected a size above zero "
                 "[m]");
  EXPECT_INVALID_WITH(with("id: 4", "id: 3"), "got tag 3 again, expected every tag once");
  EXPECT_INVALID_WITH(with("y: 0.04", "y: 0"), "expected standard deviations above zero");
  EXPECT_INVALID_WITH(with("is_static: true", "is_static: perhaps"), "expected true or false");
  EXPECT_INVALID_WITH(with("           rotation_noise: {x: 0.001, y: 0.001, z: 0.001}\n", ""),
                      "got only position_noise");
}

#endif

}  // namespace
}  // namespace posemix
