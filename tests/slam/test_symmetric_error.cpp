// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/symmetric_error.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();
const Eigen::Vector3d kOff(0.02, -0.01, 0.05);

SE3d turn_about(double angle, const Eigen::Vector3d& axis, const Eigen::Vector3d& point) {
  const SO3d rotation = SO3d::exp(angle * axis);
  return SE3d(rotation, point - rotation * point);
}

SE3d random_pose(RandomStream& stream, double rotation, double translation) {
  Vector6d xi;
  for (double& x : xi) x = stream.normal();
  xi.head<3>() *= rotation;
  xi.tail<3>() *= translation;
  return SE3d::exp(xi);
}

std::vector<Eigen::Vector3d> random_points(RandomStream& stream) {
  std::vector<Eigen::Vector3d> points(12);
  for (Eigen::Vector3d& p : points)
    for (double& x : p) x = 0.05 * stream.normal();
  return points;
}

/// The method of bop_toolkit's pose_error.mssd: the largest distance for each of a list of motions,
/// then the least of these.
double mssd_of(const SE3d& estimate, const SE3d& truth, const std::vector<Eigen::Vector3d>& points,
               const std::vector<SE3d>& motions) {
  double least = std::numeric_limits<double>::infinity();
  for (const SE3d& g : motions) {
    double most = 0.0;
    for (const Eigen::Vector3d& p : points)
      most = std::max(most, ((estimate * p) - (truth * (g * p))).norm());
    least = std::min(least, most);
  }
  return least;
}

std::vector<SE3d> turns(const SE3d& element, std::size_t steps) {
  std::vector<SE3d> motions;
  for (std::size_t k = 0; k < steps; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(steps);
    motions.push_back(element * turn_about(angle, kZ, kOff));
  }
  return motions;
}

TEST(SymmetricError, SurfaceDistanceOverElements) {
  RandomStream stream(3);
  const SE3d half = turn_about(std::numbers::pi, kZ, kOff);
  const SymmetryGroup group({half});
  for (int i = 0; i < 20; ++i) {
    const auto points = random_points(stream);
    const SE3d truth = random_pose(stream, 1.0, 0.5);
    const SE3d estimate = truth * random_pose(stream, 1.0, 0.02);
    EXPECT_NEAR(max_symmetric_surface_distance(estimate, truth, points, group),
                mssd_of(estimate, truth, points, {SE3d(), half}), 1e-14);
  }
}

TEST(SymmetricError, SurfaceDistanceAboutAnAxisIsThatOfAFineGrid) {
  RandomStream stream(4);
  const SE3d flip = turn_about(std::numbers::pi, Eigen::Vector3d::UnitX(), kOff);
  const SymmetryGroup group({flip}, {{kZ, kOff}});
  std::vector<SE3d> coarse = turns(SE3d(), 315);
  std::vector<SE3d> fine = turns(SE3d(), 20000);
  for (const SE3d& g : turns(flip, 315)) coarse.push_back(g);
  for (const SE3d& g : turns(flip, 20000)) fine.push_back(g);
  for (int i = 0; i < 20; ++i) {
    const auto points = random_points(stream);
    const SE3d truth = random_pose(stream, 1.0, 0.5);
    const SE3d estimate = truth * random_pose(stream, i % 2 == 0 ? 0.1 : 1.5, 0.01);
    const double distance = max_symmetric_surface_distance(estimate, truth, points, group);
    EXPECT_LE(distance, mssd_of(estimate, truth, points, coarse) + 1e-14);
    // Points lie within 0.25 m of the axis; half a step of the grid moves them by 4e-5 m.
    EXPECT_NEAR(distance, mssd_of(estimate, truth, points, fine), 4e-5);
  }
}

TEST(SymmetricError, TurnsOfTheGroupAreNoError) {
  RandomStream stream(5);
  const auto points = random_points(stream);
  const SE3d truth = random_pose(stream, 1.0, 0.5);
  const SymmetryGroup can({}, {{kZ, kOff}});
  const SymmetryGroup ball({}, {{kZ, kOff}, {Eigen::Vector3d::UnitX(), kOff}});
  const SE3d turned = truth * turn_about(1.234, kZ, kOff);
  EXPECT_LT(max_symmetric_surface_distance(turned, truth, points, can), 1e-9);
  EXPECT_LT(max_symmetric_surface_distance(turned, truth, points, ball), 1e-14);
  EXPECT_GT(max_symmetric_surface_distance(turned, truth, points, {}), 0.03);
  EXPECT_LT(symmetric_pose_error(turned, truth, can).rotation_rad, 1e-9);
  EXPECT_LT(symmetric_pose_error(turned, truth, can).translation_m, 1e-12);
  const SE3d shift(SO3d(), Eigen::Vector3d(0.003, 0.004, 0));
  EXPECT_NEAR(max_symmetric_surface_distance(shift * turned, truth, points, ball), 0.005, 1e-12);
  const SymmetryGroup centred({}, {{kZ, -kZ}, {Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero()}});
  const SE3d spun = shift * truth * SE3d(SO3d::exp({1, 2, 3}), Eigen::Vector3d::Zero());
  EXPECT_NEAR(symmetric_pose_error(spun, truth, centred).translation_m, 0.005, 1e-12);
}

TEST(SymmetricError, PoseErrorIsOfTheNearestEquivalent) {
  const SE3d half = turn_about(std::numbers::pi, kZ, kOff);
  const SymmetryGroup group({half});
  const SE3d truth(SO3d::exp({0.3, 0.1, -0.4}), {0.1, 0.2, 0.9});
  const SE3d tilt(SO3d::exp({0.05, 0.0, 0.0}), Eigen::Vector3d(0, 0, 0.002));
  const SymmetricPoseError error = symmetric_pose_error(truth * half * tilt, truth, group);
  EXPECT_NEAR(error.rotation_rad, 0.05, 1e-12);
  EXPECT_NEAR(error.translation_m, 0.002, 1e-12);
  EXPECT_NEAR(symmetric_pose_error(truth * half * tilt, truth, {}).translation_m,
              (half * tilt).translation().norm(), 1e-12);
}

TEST(SymmetricError, NeedsPoints) {
  EXPECT_NE(testing::thrown_message([] { max_symmetric_surface_distance({}, {}, {}, {}); }), "");
}

}  // namespace
}  // namespace posemix
