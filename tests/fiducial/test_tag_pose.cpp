// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/base/units.hpp"
#include "views.hpp"

namespace posemix {
namespace {

using testing::fisheye_camera;
using testing::image_of;
using testing::kTagSize;
using testing::pinhole_camera;
using testing::radtan_camera;
using testing::view;
using testing::with_noise;

/// A pose as OpenCV states it: rotation vector and translation.
SE3d opencv_pose(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation) {
  return SE3d(SO3d::exp(rotation), translation);
}

struct Expected {
  SE3d pose;
  double squared_error;
};

/// OpenCV prints nine digits, and its refinement stops at about 1e-8.
void expect_minima(const std::vector<TagMinimum>& minima, const std::vector<Expected>& expected) {
  ASSERT_EQ(minima.size(), expected.size());
  for (std::size_t k = 0; k < minima.size(); ++k) {
    EXPECT_TRUE(minima[k].pose.is_approx(expected[k].pose, 2e-6)) << "minimum " << k;
    EXPECT_NEAR(minima[k].squared_error, expected[k].squared_error, 1e-8);
  }
}

// Both solutions of OpenCV 5.0: solvePnPGeneric with SOLVEPNP_IPPE_SQUARE, each refined by
// solvePnPRefineLM. OpenCV's corners run from the top left clockwise.
TEST(TagPose, BothMinimaAreThoseOfOpenCv) {
  expect_minima(
      tag_minima({{{500.2, 300.1}, {531.5, 301.9}, {532.3, 270.4}, {500.9, 268.8}}}, kTagSize,
                 pinhole_camera()),
      {{opencv_pose({-3.10948673, -0.04586991, -0.10651051}, {-0.598959, -1.0935581, 2.90410395}),
        0.0257065644332},
       {opencv_pose({-2.4386462, -0.05936412, -0.42185267}, {-0.59947362, -1.09418257, 2.90880982}),
        0.332730360414}});
  expect_minima(
      tag_minima({{{800.5, 700.2}, {838.1, 692.7}, {829.9, 660.4}, {793.3, 668.9}}}, kTagSize,
                 radtan_camera()),
      {{opencv_pose({2.26425662, -0.17574335, -0.35048436}, {0.69600178, 0.66505544, 2.30144886}),
        0.409354716117},
       {opencv_pose({-2.85940532, 0.41527618, 0.3101346}, {0.69652546, 0.66719236, 2.30170826}),
        0.819926605269}});
  expect_minima(
      tag_minima({{{640.3, 520.2}, {648.9, 528.4}, {650.1, 479.5}, {641.0, 473.2}}}, kTagSize,
                 pinhole_camera()),
      {{opencv_pose({-2.31512794, -0.18580833, 1.93565563}, {0.01524847, -0.03615374, 1.8674801}),
        0.777719844348},
       {opencv_pose({2.35645467, 0.15142046, 1.93569486}, {0.01639213, -0.03627482, 1.87320148}),
        7.8329889307}});
}

TEST(TagPose, FindsThePoseOfCornersWithoutNoise) {
  for (const CameraModel& camera : {pinhole_camera(), radtan_camera(), fisheye_camera()}) {
    for (const double tilt_deg : {0.0, 5.0, 30.0, 60.0, 80.0, 87.0}) {
      for (const double distance : {0.4, 2.0, 6.0}) {
        const SE3d truth = view(distance, tilt_deg * kRadPerDeg);
        const auto minima = tag_minima(image_of(truth, camera), kTagSize, camera);
        ASSERT_FALSE(minima.empty()) << tilt_deg << " deg at " << distance << " m";
        EXPECT_LT(minima.front().squared_error, 1e-12);
        // At 6 m rounding of the pixels moves the normal by some 1e-6 rad.
        EXPECT_TRUE(minima.front().pose.is_approx(truth, 1e-5)) << tilt_deg << " " << distance;
      }
    }
  }
}

TEST(TagPose, ATagBeyondTheHorizonOfAFisheyeHasAPose) {
  CameraModel camera = fisheye_camera();
  camera.coefficients = {0.01, 0.0, 0.0, 0.0};  // without a fold behind the camera
  const SE3d turned(SO3d::exp({0.0, 100.0 * kRadPerDeg, 0.0}), Eigen::Vector3d::Zero());
  const SE3d truth = turned * view(0.8, 0.6);
  ASSERT_LT(truth.translation().z(), 0.0);
  const auto minima = tag_minima(image_of(truth, camera), kTagSize, camera);
  ASSERT_FALSE(minima.empty());
  EXPECT_TRUE(minima.front().pose.is_approx(truth, 1e-7));
}

TEST(TagPose, EveryMinimumIsOne) {
  constexpr double kStep = 1e-4;
  RandomStream stream(3);
  for (int i = 0; i < 100; ++i) {
    const SE3d truth =
        view(0.4 + 4.0 * stream.uniform(), 1.5 * stream.uniform(), 6.0 * stream.uniform());
    const TagCorners corners = with_noise(image_of(truth, fisheye_camera()), 0.5, stream);
    for (const TagMinimum& minimum : tag_minima(corners, kTagSize, fisheye_camera())) {
      const auto error_at = [&](const Vector6d& n) {
        const TagCorners image = image_of(minimum.pose * SE3d::exp(n), fisheye_camera());
        double sum = 0.0;
        for (std::size_t c = 0; c < 4; ++c) sum += (image[c] - corners[c]).squaredNorm();
        return sum;
      };
      EXPECT_NEAR(error_at(Vector6d::Zero()), minimum.squared_error, 1e-9);
      for (int axis = 0; axis < 6; ++axis) {
        const Vector6d step = kStep * Vector6d::Unit(axis);
        EXPECT_GT(error_at(step), minimum.squared_error);
        EXPECT_GT(error_at(-step), minimum.squared_error);
      }
    }
  }
}

TEST(TagPose, TheInformationIsTheCurvatureOfTheError) {
  const CameraModel camera = fisheye_camera();
  const SE3d truth = view(0.7, 0.8);
  const TagMinimum minimum = tag_minima(image_of(truth, camera), kTagSize, camera).front();
  constexpr double kStep = 1e-5;
  RandomStream stream(4);
  for (int i = 0; i < 20; ++i) {
    Vector6d n;
    for (double& value : n) value = kStep * stream.normal();
    const TagCorners image = image_of(minimum.pose * SE3d::exp(n), camera);
    double squared = 0.0;
    for (std::size_t c = 0; c < 4; ++c)
      squared += (image[c] - image_of(minimum.pose, camera)[c]).squaredNorm();
    EXPECT_NEAR(squared, n.dot(minimum.information * n), 1e-3 * squared);
  }
}

TEST(TagPose, ANearTagThatFacesTheCameraHasOnePose) {
  const CameraModel camera = pinhole_camera();
  EXPECT_EQ(tag_minima(image_of(view(0.3, 0.3), camera), kTagSize, camera).size(), 1U);
  EXPECT_EQ(tag_minima(image_of(view(3.0, 0.6), camera), kTagSize, camera).size(), 2U);
}

TEST(TagPose, OrdersOfDetectorsAreOneTag) {
  const TagCorners corners = image_of(view(1.0, 0.5), pinhole_camera());
  const TagCorners aruco = {corners[3], corners[2], corners[1], corners[0]};
  EXPECT_EQ(in_apriltag_order(aruco, CornerOrder::aruco), corners);
  EXPECT_EQ(in_apriltag_order(corners, CornerOrder::apriltag), corners);
}

TEST(TagPose, CornersThatAreNoTagHaveNoPose) {
  const TagCorners corners = image_of(view(1.0, 0.5), pinhole_camera());
  const TagCorners clockwise = {corners[3], corners[2], corners[1], corners[0]};
  EXPECT_TRUE(tag_minima(clockwise, kTagSize, pinhole_camera()).empty());
  const TagCorners line = {{{10.0, 10.0}, {20.0, 20.0}, {30.0, 30.0}, {40.0, 40.0}}};
  EXPECT_TRUE(tag_minima(line, kTagSize, pinhole_camera()).empty());
  const TagCorners point = {{{10.0, 10.0}, {10.0, 10.0}, {10.0, 10.0}, {10.0, 10.0}}};
  EXPECT_TRUE(tag_minima(point, kTagSize, pinhole_camera()).empty());
}

TEST(TagPose, RefusesWhatIsNoInput) {
  TagCorners corners = image_of(view(1.0, 0.5), pinhole_camera());
  EXPECT_INVALID(tag_minima(corners, 0.0, pinhole_camera()),
                 "the size of the tag is 0, expected metres above zero");
  corners[2].y() = std::nan("");
  EXPECT_INVALID_WITH(tag_minima(corners, kTagSize, pinhole_camera()), "expected pixels");
}

}  // namespace
}  // namespace posemix
