// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "filter/scenario.hpp"
#include "posemix/slam/object_slam.hpp"

namespace posemix {
namespace {

using testing::gaussian_noise;
using testing::isotropic;
using testing::pose;

const ConcentratedGaussian<SE3d> kPrior(pose(0.1, 0.2, -0.1, 0.3, -0.2, 0.1),
                                        isotropic(0.5, 0.005));
const SE3d kObject = pose(0.4, -0.3, 0.2, 0.1, 0.2, 1.1);

ObjectModel model(const std::string& id) { return {id, gaussian_noise(), std::nullopt}; }

/// Uses the Gaussian-sum filter, whose results are known exactly; the code around it is the same
/// for both filters.
ObjectSlam make(ObjectSlamSettings settings = {}) {
  settings.kind = SlamFilter::gaussian_sum;
  return ObjectSlam(kPrior, {model("a"), model("b")}, settings);
}

std::optional<SE3d> seen(const SE3d& camera = kPrior.mean()) { return camera.inverse() * kObject; }

TEST(ObjectSlamTest, FramesWithNothingAreValid) {
  ObjectSlam slam = make();
  const FrameReport first = slam.start({std::nullopt, std::nullopt});
  EXPECT_EQ(first.statuses, std::vector(2, DetectionStatus::none));
  EXPECT_EQ(slam.estimate().mean().size(), 1U);
  slam.step({0.1, std::nullopt, {std::nullopt, std::nullopt}});
  EXPECT_TRUE(slam.estimate().mean()[kCamera].is_approx(kPrior.mean(), 1e-12));
  EXPECT_FALSE(slam.pose_index(0).has_value());
}

TEST(ObjectSlamTest, ObjectsEnterInTheOrderSeenAndAtAnyFrame) {
  ObjectSlam slam = make();
  slam.start({std::nullopt, std::nullopt});
  EXPECT_EQ(slam.step({0.1, SE3d(), {std::nullopt, seen()}}).statuses[1], DetectionStatus::started);
  EXPECT_EQ(slam.pose_index(1), std::optional<std::size_t>(1));
  const FrameReport report = slam.step({0.1, SE3d(), {seen(), seen()}});
  EXPECT_EQ(report.statuses[0], DetectionStatus::started);
  EXPECT_EQ(report.statuses[1], DetectionStatus::used);
  EXPECT_EQ(slam.pose_index(0), std::optional<std::size_t>(2));
  EXPECT_EQ(slam.estimate().mean().size(), 3U);
}

TEST(ObjectSlamTest, MissingOdometryIsARandomWalkOfTheUnknownMotion) {
  ObjectSlamSettings settings;
  settings.motion.unknown_motion = {isotropic(10.0, 0.1), NoisePer::second};
  ObjectSlam known = make(settings);
  ObjectSlam unknown = make(settings);
  for (ObjectSlam* slam : {&known, &unknown}) slam->start({std::nullopt, std::nullopt});
  known.step({0.5, SE3d(), {std::nullopt, std::nullopt}});
  unknown.step({0.5, std::nullopt, {std::nullopt, std::nullopt}});
  const Matrix6d added = unknown.estimate().covariance() - kPrior.covariance();
  EXPECT_TRUE(added.isApprox(kPrior.mean().adjoint_congruence(0.5 * isotropic(10.0, 0.1)), 1e-9));
  EXPECT_LT(known.estimate().covariance()(0, 0), unknown.estimate().covariance()(0, 0));
}

TEST(ObjectSlamTest, IndependentStartKeepsTheGivenCovarianceAndNoCrossTerms) {
  ObjectModel independent = model("a");
  independent.independent_start = isotropic(4.0, 0.1);
  ObjectSlamSettings settings;
  settings.kind = SlamFilter::gaussian_sum;
  ObjectSlam slam(kPrior, {independent}, settings);
  slam.start({seen()});
  const Eigen::MatrixXd p = slam.estimate().covariance();
  EXPECT_TRUE(p.bottomRightCorner(6, 6).isApprox(isotropic(4.0, 0.1), 1e-14));
  EXPECT_EQ(p.topRightCorner(6, 6).cwiseAbs().maxCoeff(), 0.0);
}

TEST(ObjectSlamTest, ConstantVelocityKeepsTheMotionInTheState) {
  ObjectSlamSettings settings;
  settings.motion.model = MotionModel::constant_velocity;
  ObjectSlam slam = make(settings);
  slam.start({seen(), std::nullopt});
  EXPECT_EQ(slam.estimate().mean().size(), 3U);
  EXPECT_EQ(slam.pose_index(0), std::optional<std::size_t>(2));
  SE3d camera = kPrior.mean();
  const SE3d motion = pose(0.01, 0.0, -0.01, 0.01, 0.0, 0.0);
  for (int frame = 0; frame < 80; ++frame) {
    camera = camera * motion;
    slam.step({0.1, std::nullopt, {seen(camera), std::nullopt}});
  }
  EXPECT_LT((slam.estimate().mean()[kMotion] * motion.inverse()).log().norm(), 2e-3);
}

TEST(ObjectSlamTest, TheDefaultIsTheMultiObjectFilterAndSaysWhatBecameOfDetections) {
  ObjectSlam slam(kPrior, {{.id = "a"}, {.id = "b"}}, {});
  ASSERT_NE(slam.multi_object(), nullptr);
  EXPECT_EQ(slam.start({seen(), std::nullopt}).statuses,
            (std::vector{DetectionStatus::started, DetectionStatus::none}));
  EXPECT_EQ(slam.step({0.1, SE3d(), {seen(), std::nullopt}}).statuses[0], DetectionStatus::used);
  const std::optional<SE3d> flipped = *seen() * pose(0, 3.0, 0, 0, 0, 0);
  EXPECT_EQ(slam.step({0.1, SE3d(), {flipped, std::nullopt}}).statuses[0], DetectionStatus::birth);
  for (int i = 0; i < 5; ++i) slam.step({0.1, SE3d(), {seen(), std::nullopt}});
  EXPECT_EQ(slam.step({0.1, SE3d(), {flipped, std::nullopt}}).statuses[0],
            DetectionStatus::doubted);
  EXPECT_EQ(slam.pose_index(0), std::optional<std::size_t>(1));
  EXPECT_FALSE(slam.pose_index(1).has_value());
  EXPECT_EQ(slam.multi_object()->hypotheses(0).size(), 2U);
  EXPECT_EQ(slam.posterior().size(), 1U);
  // Without odometry for a frame the camera is as uncertain as the unknown motion.
  const double known = slam.estimate().covariance()(0, 0);
  slam.step({0.1, std::nullopt, {std::nullopt, std::nullopt}});
  EXPECT_GT(slam.estimate().covariance()(0, 0),
            known + 0.9 * MotionSettings().unknown_motion.over(0.1)(0, 0));
}

TEST(ObjectSlamTest, AnIndependentStartIsRefusedByTheMultiObjectFilter) {
  ObjectModel independent = model("a");
  independent.independent_start = isotropic(4.0, 0.1);
  EXPECT_THROW(ObjectSlam(kPrior, {independent}, {}), InvalidInput);
}

TEST(ObjectSlamTest, RefusesInputOfTheWrongShape) {
  ObjectSlam slam = make();
  EXPECT_THROW(slam.start({std::nullopt}), InvalidInput);
  slam.start({std::nullopt, std::nullopt});
  EXPECT_THROW(slam.step({0.0, SE3d(), {std::nullopt, std::nullopt}}), InvalidInput);
  EXPECT_THROW(slam.step({-1.0, SE3d(), {std::nullopt, std::nullopt}}), InvalidInput);
  EXPECT_THROW(slam.step({0.1, SE3d(), {}}), InvalidInput);
  ObjectSlamSettings settings;
  settings.motion.period_s = 0.0;
  EXPECT_THROW(make(settings), InvalidInput);
}

}  // namespace
}  // namespace posemix
