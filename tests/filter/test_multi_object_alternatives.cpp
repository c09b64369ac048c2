// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "multi_object_scene.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::OrbitScene;
using testing::pose;

constexpr std::size_t kObjects = 5;
constexpr std::size_t kModes = 3;

SE3d mode_of(std::size_t mode) {
  return pose(0, 0, 2.0 * std::numbers::pi / kModes * static_cast<double>(mode), 0, 0, 0);
}

bool holds(const std::vector<ObjectHypothesis>& hypotheses, const SE3d& wanted) {
  return std::any_of(hypotheses.begin(), hypotheses.end(), [&](const ObjectHypothesis& h) {
    const double angle = (h.pose.rotation().inverse() * wanted.rotation()).log().norm();
    return degrees(angle) < 20.0 && (h.pose.translation() - wanted.translation()).norm() < 0.1;
  });
}

struct Alive {
  std::size_t modes = 0;  ///< modes seen eight times or more
  std::size_t kept = 0;
};

/// Five objects over 120 frames, each detected in one of three modes at random, with 5 % gross
/// errors.
Alive alternatives(std::uint64_t seed, std::size_t max_hypotheses) {
  OrbitScene scene(seed, kObjects, 0.01, 0.15e-3);
  MultiObjectSettings settings = testing::plain_settings();
  settings.max_hypotheses = max_hypotheses;
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           std::vector<ObjectSensor>(kObjects, {testing::ray_noise()}), settings);
  std::array<std::array<int, kModes>, kObjects> seen{};
  for (int frame = 0; frame < 120; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    for (std::size_t j = 0; j < kObjects; ++j) {
      if (scene.stream.uniform() < 0.05) {
        filter.update(j, scene.detect(j, 0.0, 1.0));
        continue;
      }
      const auto mode =
          std::min(kModes - 1, static_cast<std::size_t>(kModes * scene.stream.uniform()));
      ++seen[j][mode];
      filter.update(j, scene.detect(j, 0.0, 0.0) * mode_of(mode));
    }
  }
  Alive alive;
  for (std::size_t j = 0; j < kObjects; ++j) {
    for (std::size_t mode = 0; mode < kModes; ++mode) {
      if (seen[j][mode] < 8) continue;
      ++alive.modes;
      alive.kept += holds(filter.hypotheses(j), scene.truth[j] * mode_of(mode)) ? 1 : 0;
    }
  }
  return alive;
}

// A joint filter needs 3^5 = 243 hypotheses for this.
TEST(MultiObjectAlternatives, NoneOfFifteenIsLostWithEightHypothesesPerObject) {
  int complete = 0;
  Alive sum;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const Alive one = alternatives(seed, 8);
    complete += one.kept == one.modes ? 1 : 0;
    sum.modes += one.modes;
    sum.kept += one.kept;
  }
  std::printf("%zu of %zu modes kept, all of them in %d of 16 runs\n", sum.kept, sum.modes,
              complete);
  EXPECT_GT(sum.modes, 220U);
  EXPECT_GE(complete, 15);
}

// With plain settings the covariances of the filter are the reported ones.
TEST(MultiObjectAlternatives, JointOfGivenHypothesesHasTheirMoments) {
  OrbitScene scene(3, 2, 0.1, 1e-3);
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           std::vector<ObjectSensor>(2, {testing::ray_noise()}),
                           testing::plain_settings());
  for (int frame = 0; frame < 30; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    for (const std::size_t j : {0U, 1U}) filter.update(j, scene.detect(j, 0.4, 0.0));
  }
  const std::size_t leads = *filter.leading(0);
  const auto joint = filter.joint_of(std::vector{filter.leading(0), filter.leading(1)});
  EXPECT_EQ(joint.covariance(), filter.joint().covariance());

  const auto hypotheses = filter.hypotheses(0);
  ASSERT_GT(hypotheses.size(), 1U);
  const std::size_t other = leads == 0 ? 1 : 0;
  const auto alone = filter.joint_of(std::vector<std::optional<std::size_t>>{other, std::nullopt});
  ASSERT_EQ(alone.mean().size(), 2U);
  EXPECT_EQ(alone.mean()[1].matrix(), hypotheses[other].pose.matrix());
  const Eigen::MatrixXd& p = alone.covariance();
  EXPECT_TRUE(p.bottomRightCorner(6, 6).isApprox(hypotheses[other].covariance, 1e-12));
  EXPECT_TRUE(p.bottomLeftCorner(6, 6).isApprox(hypotheses[other].cross_covariance, 1e-12));
  EXPECT_TRUE(p.topLeftCorner(6, 6).isApprox(filter.camera().covariance(), 1e-12));
}

/// Log probability that the object was never detected, after three right detections.
double absent_after_three(double clutter, double default_clutter, double volume_m3) {
  OrbitScene scene(3, 1, 0.01, 0.15e-3);
  MultiObjectSettings settings = testing::plain_settings();
  settings.default_clutter = default_clutter;
  const DetectorNoise noise(testing::ray_noise().components(),
                            {.weight = clutter, .volume_m3 = volume_m3});
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           std::vector<ObjectSensor>(1, {noise}), settings);
  for (int frame = 0; frame < 3; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    filter.update(0, scene.detect(0, 0.0, 0.0));
  }
  return filter.log_absent(0);
}

TEST(MultiObjectFilter, DefaultClutterKeepsTheStatedVolume) {
  constexpr double kVolume = 0.01;
  // The weights of the components sum to 0.77: clutter of a third of that has probability 0.25.
  EXPECT_NEAR(absent_after_three(0.0, 0.25, kVolume), absent_after_three(0.77 / 3.0, 0.0, kVolume),
              1e-9);
  EXPECT_GT(absent_after_three(0.0, 0.2, kVolume), absent_after_three(0.0, 0.2, 1.0) + 1.0);
}

}  // namespace
}  // namespace posemix
