// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/fiducial/camera_model.hpp"
#include "views.hpp"

namespace posemix {
namespace {

using testing::fisheye_camera;
using testing::pinhole_camera;
using testing::radtan_camera;

void expect_near(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double tolerance) {
  EXPECT_LT((a - b).norm(), tolerance) << a.transpose() << " and " << b.transpose();
}

// Values of OpenCV 5.0 (projectPoints, fisheye.projectPoints) for the same cameras.
TEST(CameraModel, ProjectsAsOpenCv) {
  expect_near(project(radtan_camera(), {0.3, -0.4, 1.2})->pixel,
              {784.8281394675926, 318.28697138631685}, 1e-9);
  expect_near(project(fisheye_camera(), {0.3, -0.4, 1.2})->pixel,
              {781.8087861685062, 322.29135717013173}, 1e-9);
  expect_near(project(fisheye_camera(), {1.5, 0.7, 0.4})->pixel,
              {1342.3749211596455, 840.8675464185274}, 1e-9);
}

// Values of OpenCV 5.0 (fisheye.undistortPoints).
TEST(CameraModel, RaysOfAFisheyeAreThoseOfOpenCv) {
  const auto straight = [](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
    return ray(fisheye_camera(), pixel)->hnormalized();
  };
  expect_near(straight({100.25, 90.5}), {-1.832916308760986, -1.426600337875303}, 1e-9);
  expect_near(straight({641.0, 513.0}), {1.666669862828709e-03, 1.661132753649876e-03}, 1e-12);
  expect_near(straight({1200.0, 700.0}), {1.475206151282309, 0.4936024378993963}, 1e-9);
}

TEST(CameraModel, ARayIsTheWayBackOfAProjection) {
  for (const CameraModel& camera : {pinhole_camera(), radtan_camera(), fisheye_camera()}) {
    RandomStream stream(1);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d pixel(1280.0 * stream.uniform(), 1024.0 * stream.uniform());
      const auto seen = ray(camera, pixel);
      ASSERT_TRUE(seen.has_value());
      EXPECT_NEAR(seen->norm(), 1.0, 1e-14);
      expect_near(project(camera, 2.5 * *seen)->pixel, pixel, 1e-8);
    }
  }
}

TEST(CameraModel, ARayOfAFisheyeCanPointBackwards) {
  CameraModel camera = fisheye_camera();
  camera.coefficients = {0.01, 0.0, 0.0, 0.0};  // without a fold behind the camera
  const Eigen::Vector3d behind(1.0, 0.5, -0.2);
  const auto seen = ray(camera, project(camera, behind)->pixel);
  ASSERT_TRUE(seen.has_value());
  EXPECT_LT((*seen - behind.normalized()).norm(), 1e-10);
}

TEST(CameraModel, TheJacobianIsThatOfTheProjection) {
  constexpr double kStep = 1e-6;
  for (const CameraModel& camera : {pinhole_camera(), radtan_camera(), fisheye_camera()}) {
    for (const Eigen::Vector3d& point :
         {Eigen::Vector3d(0.3, -0.2, 1.0), Eigen::Vector3d(0.0, 0.0, 1.5),
          Eigen::Vector3d(-0.6, 0.1, 0.7)}) {
      const auto at = project(camera, point);
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector2d slope =
            (project(camera, point + step)->pixel - project(camera, point - step)->pixel) /
            (2.0 * kStep);
        // Central differences of values near 1000: rounding of about 1e-13 * 1000 / 1e-6.
        EXPECT_LT((at->jacobian.col(axis) - slope).norm(), 1e-3 * kStep * 1e6);
        EXPECT_LT((at->jacobian.col(axis) - slope).norm(), 1e-5 * (1.0 + slope.norm()));
      }
    }
  }
}

TEST(CameraModel, HasNoImageOfWhatIsBehind) {
  EXPECT_FALSE(project(pinhole_camera(), {0.1, 0.1, -1.0}).has_value());
  EXPECT_FALSE(project(radtan_camera(), {0.1, 0.1, 0.0}).has_value());
  EXPECT_FALSE(project(fisheye_camera(), {0.0, 0.0, 0.0}).has_value());
  EXPECT_FALSE(project(fisheye_camera(), {0.0, 0.0, -1.0}).has_value());
}

TEST(CameraModel, HasNoRayBeyondTheReachOfItsDistortion) {
  CameraModel camera = radtan_camera();
  camera.coefficients = {-0.5, 0.0, 0.0, 0.0};  // folds back at a radius of 0.8
  EXPECT_FALSE(ray(camera, {640.0 + 600.0, 512.0}).has_value());
}

TEST(CameraModel, RefusesWhatIsNoCamera) {
  CameraModel camera = fisheye_camera();
  camera.coefficients.pop_back();
  EXPECT_INVALID(validate(camera),
                 "got 3 coefficients of the distortion, expected 4 (k1 k2 k3 k4) for equidistant");
  camera = pinhole_camera();
  camera.intrinsics[1] = -3.0;
  EXPECT_INVALID_WITH(validate(camera), "expected fx, fy, cx, cy [px] with positive focal lengths");
}

}  // namespace
}  // namespace posemix
