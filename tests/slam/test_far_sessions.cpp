// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "posemix/slam/stamped_slam.hpp"
#include "state_scene.hpp"

/// A session with objects that stay, move and are held, in a world whose origin is elsewhere.
namespace posemix {
namespace {

using testing::RichScene;

PoseDensity moved(const SE3d& world, const PoseDensity& pose) {
  return {world * pose.mean(), world.adjoint_congruence(pose.covariance())};
}

/// What is stated of all objects now and then, from the camera.
std::vector<FrameEstimate> estimates_in(const SE3d& world, MotionModel model, std::uint64_t seed) {
  auto models = RichScene::models();
  for (ObjectModel& one : models)
    if (one.prior) one.prior->world = moved(world, one.prior->world);
  MotionSettings motion;
  motion.model = model;
  if (model == MotionModel::given)
    motion.noise = {.covariance = testing::isotropic(0.1, 0.002), .per = NoisePer::frame};
  const SE3d body = RichScene::body_at(0);
  const SE3d about(SO3d(), body.translation());
  const PoseDensity start(body, about.adjoint_congruence(testing::isotropic(0.1, 0.001)));
  StampedSlam slam(moved(world, start), models, RichScene::settings(), motion,
                   {.on_jump_back = StampJump::reset}, true);
  RichScene scene(seed);
  std::vector<FrameEstimate> found;
  int given = 0;
  for (testing::StampedInput input : scene.session(6.0)) {
    if (auto* odometry = std::get_if<testing::StampedOdometry>(&input))
      odometry->odom_body = world * odometry->odom_body;
    if (auto* gripper = std::get_if<testing::StampedGripper>(&input))
      gripper->world_gripper = world * gripper->world_gripper;
    testing::give(slam, input);
    if (++given % 20 != 0) continue;
    if (const auto estimate = slam.estimate()) found.push_back(estimate->estimate);
  }
  return found;
}

struct FarSession {
  MotionModel motion;
  std::uint64_t seed;
};

class FarSessions : public ::testing::TestWithParam<FarSession> {};

TEST_P(FarSessions, StateTheSameOfAllObjects) {
  const auto near = estimates_in(SE3d(), GetParam().motion, GetParam().seed);
  ASSERT_GT(near.size(), 10);
  for (const double distance : {1e4, 1e5}) {
    const SE3d world(SO3d(), {distance, -0.6 * distance, 0.1 * distance});
    const auto far = estimates_in(world, GetParam().motion, GetParam().seed);
    ASSERT_EQ(far.size(), near.size());
    std::size_t compared = 0;
    for (std::size_t k = 0; k < near.size(); ++k) {
      for (std::size_t j = 0; j < near[k].relative.size(); ++j) {
        const auto& a = near[k].relative[j];
        const auto& b = far[k].relative[j];
        ASSERT_EQ(a.has_value(), b.has_value()) << (*near[k].ids)[j];
        if (!a) continue;
        const std::string name = (*near[k].ids)[j] + " at " + std::to_string(distance);
        const Vector6d xi = (a->mean() * b->mean().inverse()).log();
        EXPECT_LT(std::sqrt(xi.dot(a->covariance().llt().solve(xi))), 0.05) << name;
        EXPECT_LT((a->covariance() - b->covariance()).norm(), 0.05 * a->covariance().norm())
            << name;
        ++compared;
      }
    }
    EXPECT_GT(compared, 50);
  }
}

// In the last two, rounding of coordinates about a far origin decided between cases of the tool.
INSTANTIATE_TEST_SUITE_P(
    Motions, FarSessions,
    ::testing::Values(FarSession{MotionModel::odometry, 1}, FarSession{MotionModel::given, 1},
                      FarSession{MotionModel::odometry, 12}, FarSession{MotionModel::odometry, 29}),
    [](const auto& given) {
      return (given.param.motion == MotionModel::given ? "given" : "odometry") +
             std::to_string(given.param.seed);
    });

}  // namespace
}  // namespace posemix
