// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <gtest/gtest.h>

#include "simulation_samples.hpp"

/// Paths of simulated objects.
namespace posemix {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace)

std::vector<SE3d> path_of(const SimulationConfig& config, std::uint64_t seed = 1) {
  const SimulatedSequence simulated = simulate(config, seed);
  std::vector<SE3d> poses;
  for (std::size_t k = 0; k < simulated.stamps_ns.size(); ++k)
    poses.push_back(simulated.objects[0].world_at(k).pose());
  return poses;
}

/// The largest step between frames, of position and of rotation.
std::pair<double, double> largest_step(const std::vector<SE3d>& path) {
  std::pair<double, double> largest{0.0, 0.0};
  for (std::size_t k = 1; k < path.size(); ++k) {
    largest.first =
        std::max(largest.first, (path[k].translation() - path[k - 1].translation()).norm());
    largest.second = std::max(largest.second,
                              (path[k - 1].rotation().inverse() * path[k].rotation()).log().norm());
  }
  return largest;
}

/// The largest change of the velocity between frames.
double largest_change(const std::vector<SE3d>& path) {
  double largest = 0.0;
  for (std::size_t k = 2; k < path.size(); ++k) {
    const Vector3d bend =
        path[k].translation() - 2.0 * path[k - 1].translation() + path[k - 2].translation();
    largest = std::max(largest, bend.norm() / kPeriod);
  }
  return largest;
}

TEST(SimulationMotion, AConveyorHasItsSpeedBetweenItsTimes) {
  SimulationObject object = mug();
  object.conveyor = {
      {.start_s = 1.0, .stop_s = 3.0, .velocity_m_s = {0.1, 0, 0}, .turn_rad_s = {0, 0, 0.5}},
      {.start_s = 4.0, .velocity_m_s = {0, 0.2, 0}}};
  const std::vector<SE3d> path = path_of(moving(object, 6.0));
  const SE3d first = path.front();
  EXPECT_TRUE(path[frame_at(1.0)].is_approx(first, 1e-8));
  EXPECT_TRUE(path[frame_at(2.0)].is_approx(SE3d(SO3d::exp(Vector3d(0, 0, 0.5)) * first.rotation(),
                                                 first.translation() + Vector3d(0.1, 0, 0)),
                                            1e-8));
  EXPECT_TRUE(path[frame_at(3.5)].is_approx(SE3d(SO3d::exp(Vector3d(0, 0, 1.0)) * first.rotation(),
                                                 first.translation() + Vector3d(0.2, 0, 0)),
                                            1e-8));
  EXPECT_NEAR(
      (path[frame_at(5.0)].translation() - path[frame_at(3.5)].translation() - Vector3d(0, 0.2, 0))
          .norm(),
      0.0, 1e-8);
}

TEST(SimulationMotion, AHandStartsAndStopsAndStaysWithinItsReach) {
  SimulationObject object = mug();
  object.hand_held = {{.start_s = 1.0, .stop_s = 21.0}};
  const SimulationHandHeld& hand = object.hand_held.front();
  double farthest = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<SE3d> path = path_of(moving(object, 23.0), seed);
    for (const SE3d& pose : path) {
      const Vector3d way = (pose.translation() - path[0].translation()).cwiseAbs();
      EXPECT_TRUE((way.array() <= hand.reach_m.array() + 1e-8).all()) << way.transpose();
      const Vector3d turn = (path[0].rotation().inverse() * pose.rotation()).log();
      EXPECT_LE(turn.cwiseAbs().maxCoeff(), std::sqrt(3.0) * hand.reach_rad + 1e-8);
      farthest = std::max(farthest, way.cwiseQuotient(hand.reach_m).maxCoeff());
    }
    EXPECT_TRUE(path[frame_at(1.0)].is_approx(path[0], 1e-8));
    EXPECT_TRUE(path[frame_at(21.0)].is_approx(path.back(), 1e-8));
    EXPECT_FALSE(path.back().is_approx(path[0], 1e-2));
    // Velocities are continuous: 5 standard deviations of what white acceleration changes in two
    // periods, with 20 seeds of 1000 frames and three axes, and the forces of the oscillators.
    EXPECT_LT(largest_change(path),
              7.0 * 5.0 * 0.4 * std::sqrt(2.0 * kPeriod) + 0.1 * 5.0 * kPeriod * 50.0);
  }
  EXPECT_GT(farthest, 0.6);
}

TEST(SimulationMotion, AHandHasTheStatedAcceleration) {
  SimulationObject object = mug();
  object.rotation_rad = Vector3d::Zero();
  object.hand_held = {{.stop_s = 1e6, .agile_s = 0.0, .ramp_s = 0.0}};
  object.hand_held[0].reach_m = Vector3d::Constant(10.0);  // oscillators so slow that none bends
  object.hand_held[0].acceleration.translation_m = Vector3d(0.2, 0.4, 0.8);
  const std::vector<SE3d> path = path_of(moving(object, 400.0));
  Vector3d squared = Vector3d::Zero();
  for (std::size_t k = 2; k < path.size(); ++k) {
    const Vector3d bend =
        path[k].translation() - 2.0 * path[k - 1].translation() + path[k - 2].translation();
    squared += bend.cwiseAbs2();
  }
  // Of an integrated Brownian motion, 2/3 a^2 dt^3; of two steps of integration per period, 3/4.
  const Vector3d variance = squared / static_cast<double>(path.size() - 2);
  const Vector3d expected(0.04, 0.16, 0.64);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double share = variance[i] / (expected[i] * std::pow(kPeriod, 3));
    EXPECT_GT(share, 2.0 / 3.0 - 0.05) << i;
    EXPECT_LT(share, 3.0 / 4.0 + 0.05) << i;
  }
}

TEST(SimulationMotion, APathDoesNotDependOnTheFrames) {
  SimulationObject object = mug();
  object.hand_held = {{.start_s = 1.0}};
  SimulationConfig config = moving(object, 8.0);
  const std::vector<SE3d> fine = path_of(config);
  config.path.period_s = 5 * kPeriod;
  config.path.frames = 50;
  const std::vector<SE3d> coarse = path_of(config);
  for (std::size_t k = 0; k < coarse.size(); ++k)
    EXPECT_TRUE(coarse[k].is_approx(fine[5 * k], 1e-8)) << k;
}

TEST(SimulationMotion, AnObjectIsPickedCarriedAndPutDownWhereStated) {
  SimulationObject object = mug();
  object.pick_and_place = {
      {.moves = {.times_s = {1.0, 4.0}, .places = {{{0.3, 0.1, 0.05}, {0, 0, 1.0}}, {}}},
       .duration_s = 2.0,
       .lift_m = 0.15}};
  const std::vector<SE3d> path = path_of(moving(object, 8.0));
  const SE3d place(SO3d::exp(Vector3d(0, 0, 1.0)), Vector3d(0.3, 0.1, 0.05));
  EXPECT_TRUE(path[frame_at(1.0)].is_approx(path[0], 1e-8));
  EXPECT_TRUE(path[frame_at(3.0)].is_approx(place, 1e-8));
  EXPECT_TRUE(path[frame_at(4.0)].is_approx(place, 1e-8));
  EXPECT_TRUE(path.back().is_approx(SE3d(), 1e-8));
  // Half-way it is in the middle and lifted; no step is longer than those at the largest speeds,
  // 1.875 of the way, and 64 0.0179 of the lift, per duration.
  const double height = (path[0].translation() + place.translation()).z() / 2 + 0.15;
  EXPECT_NEAR(path[frame_at(2.0)].translation().z(), height, 1e-8);
  const double way = (place.translation() - path[0].translation()).norm();
  EXPECT_LT(largest_step(path).first, (1.875 * way + 1.8 * 0.15) / 2.0 * kPeriod * 1.5);
  EXPECT_LT(largest_change(path), 0.1);
}

TEST(SimulationMotion, MovesComeAtTheirRateWithinTheArea) {
  SimulationObject object = mug();
  object.put_down = {{.moves = {.start_s = 10.0, .rate_per_s = 0.5, .area_m = {0.2, 0.1, 0.0}}}};
  const std::vector<SE3d> path = path_of(moving(object, 2010.0));
  int moves = 0;
  for (std::size_t k = 1; k < path.size(); ++k) {
    if (path[k].is_approx(path[k - 1], 1e-8)) continue;
    ++moves;
    const Vector3d way = path[k].translation() - path[0].translation();
    EXPECT_TRUE((way.cwiseAbs().array() <= Vector3d(0.2, 0.1, 1e-8).array()).all());
    EXPECT_NEAR((path[k].rotation() * path[0].rotation().inverse() * Vector3d::UnitZ()).z(), 1.0,
                1e-8);
  }
  EXPECT_TRUE(path[frame_at(9.9)].is_approx(path[0], 1e-8));
  EXPECT_NEAR(moves, 1000, kBound * std::sqrt(1000.0));
}

TEST(SimulationMotion, AnObjectThatIsPutDownIsHiddenInBetween) {
  SimulationObject object = mug();
  object.put_down = {
      {.moves = {.times_s = {2.0}, .places = {{{0.3, 0, 0}, {0, 0, 0}}}}, .hidden_s = 1.0}};
  const SimulatedSequence simulated = simulate(moving(object, 5.0), 1);
  const SimulatedObject& result = simulated.objects[0];
  for (std::size_t k = 0; k < result.detections.size(); ++k) {
    const bool hidden = k >= frame_at(2.0) && k < frame_at(3.0);
    EXPECT_EQ(result.is_present(k), !hidden) << k;
    EXPECT_EQ(result.detections[k].has_value(), !hidden) << k;
    EXPECT_EQ(simulated.sequence().objects[0].world_truth[k].has_value(), !hidden) << k;
    if (k >= frame_at(3.0)) {
      EXPECT_NEAR(result.world_at(k).pose().translation().x(), 0.3, 1e-8);
    }
  }
}

}  // namespace
}  // namespace posemix
