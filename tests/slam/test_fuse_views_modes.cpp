// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "posemix/base/error.hpp"
#include "posemix/slam/observed_error.hpp"
#include "view_scene.hpp"

/// Which poses and which observations views agree on.
namespace posemix {
namespace {

using namespace testing::views;  // NOLINT(google-build-using-namespace)

TEST(FuseViewsModes, AFlippedViewIsOutvotedAndStillCountsForThePlace) {
  std::vector<View> views = exact_views({object_at()});
  SE3d& flipped = views[1].observations[0].components[0].pose;
  flipped = flipped * turn(180.0);
  const auto instances = fuse_views(views, {{"cup", {white_noise(), {}}}});
  ASSERT_EQ(instances.size(), 1U);
  const FusedInstance& instance = instances[0];
  EXPECT_LT((object_at().inverse() * instance.density[0].density.mean()).rotation().angle(), 1e-6);
  EXPECT_GT(instance.probability, 0.99);
  ASSERT_EQ(instance.support.size(), 4U);
  EXPECT_LT(instance.support[1].probability, 1e-3);
  EXPECT_GT(instance.support[2].probability, 0.9);
  EXPECT_NEAR(instance.supporting_views, 3.0, 0.2);
}

// Where views from the same side show the flip, it is not certain that they are right.
TEST(FuseViewsModes, ViewsFromOneSideCountOnceForTheMode) {
  const SE3d truth = object_at();
  std::vector<View> views;
  for (const double angle : {0.0, 2.0, 90.0}) {
    View view{camera_at(angle), {}};
    const SE3d pose = angle < 10.0 ? truth * turn(180.0) : truth;
    view.observations.push_back(seen(view.world_camera.inverse() * pose));
    views.push_back(view);
  }
  // So wide that the flip's odds stay moderate.
  const NoiseComponent wide{
      .weight = 0.9,
      .covariance = pose_covariance(Eigen::Vector3d::Constant(0.2), {0.02, 0.02, 0.1}),
      .frame = NoiseFrame::ray};
  const ViewClasses classes{{"cup", {DetectorNoise({wide}, {.weight = 0.1}), {}}}};
  FuseViewsSettings settings;
  settings.prune_below = 0.0;
  settings.mode_angle_rad = 0.0;
  const auto flip_odds = [&] {
    const auto density = fuse_views(views, classes, settings).front().density;
    if (density.size() < 2) throw InvalidInput("got one mode, expected two");
    EXPECT_LT((density[0].density.mean().inverse() * truth * turn(180.0)).rotation().angle(), 1e-6);
    return density[0].log_weight - density[1].log_weight;
  };
  const double independent = flip_odds();
  settings.mode_angle_rad = radians(30.0);
  // The shares of the views: 1 / (1 + exp(-2 / 30) + exp(-90 / 30)) and so on, of which the mean.
  // A mode is a sum over hypotheses, so that its odds are not quite a power.
  EXPECT_NEAR(flip_odds() / independent, (0.504 + 0.503 + 0.907) / 3.0, 0.01);
}

TEST(FuseViewsModes, AMissingViewAndClutterCostProbability) {
  const ViewClasses classes{{"cup", {white_noise(), {}}}};
  std::vector<View> views = exact_views({object_at()});
  const double all = fuse_views(views, classes).front().probability;
  views[3].observations.clear();
  views[2].observations = {seen(SE3d(SO3d(), {0.4, 0.3, 1.5}))};
  const auto instances = fuse_views(views, classes);
  ASSERT_EQ(instances.size(), 2U);
  EXPECT_LT(position_error(instances[0], object_at()), 1e-6);
  EXPECT_EQ(instances[0].support.size(), 2U);
  EXPECT_LT(instances[0].probability, all);
  EXPECT_LT(instances[1].probability, instances[0].probability);
}

TEST(FuseViewsModes, NeighboursOfOneClassStayTwo) {
  const SE3d left = object_at(0.0, -0.03), right = object_at(0.0, 0.03);
  std::vector<View> views = exact_views({left, right});
  std::swap(views[2].observations[0], views[2].observations[1]);
  const auto instances = fuse_views(views, {{"cup", {white_noise(), {}}}});
  ASSERT_EQ(instances.size(), 2U);
  for (const FusedInstance& instance : instances) {
    EXPECT_EQ(instance.support.size(), 4U);
    EXPECT_LT(std::min(position_error(instance, left), position_error(instance, right)), 1e-4);
  }
  EXPECT_GT((instances[0].density[0].density.mean().translation() -
             instances[1].density[0].density.mean().translation())
                .norm(),
            0.05);
}

TEST(FuseViewsModes, EquivalentPosesAgree) {
  const std::vector<SymmetryGroup> groups{SymmetryGroup::turns({0.0, 0.0, 1.0}, 2),
                                          SymmetryGroup::turns({0.0, 0.0, 1.0}, 0)};
  for (const SymmetryGroup& group : groups) {
    std::vector<View> views = exact_views({object_at()});
    for (std::size_t v = 0; v < views.size(); ++v) {
      SE3d& pose = views[v].observations[0].components[0].pose;
      pose = pose * turn(group.axes().empty() ? 180.0 * double(v % 2) : 70.0 * double(v));
    }
    const auto declared = fuse_views(views, {{"cup", {white_noise(), group}}});
    ASSERT_EQ(declared.size(), 1U);
    EXPECT_GT(declared[0].supporting_views, 3.9);
    const auto& density = declared[0].density[0].density;
    EXPECT_LT(ErrorReduction(group).nees(density, object_at()), 1e-3);
    const double about_axis = density.body_covariance()(2, 2);
    const double uniform = std::numbers::pi * std::numbers::pi / 3.0;
    if (group.axes().empty()) {
      EXPECT_LT(about_axis, 1e-3);
    } else {
      EXPECT_NEAR(about_axis, uniform, 1e-2);
    }
    const auto none = fuse_views(views, {{"cup", {white_noise(), {}}}});
    EXPECT_LT(none[0].supporting_views, 2.5);
  }
}

TEST(FuseViewsModes, TheOtherModeOfAnObservationIsFound) {
  std::vector<View> views = exact_views({object_at()});
  for (View& view : views) {
    auto& components = view.observations[0].components;
    components[0].weight = 0.4;
    // Every view prefers another wrong pose.
    const double wrong = 60.0 + 70.0 * double(&view - views.data());
    components.push_back({.weight = 0.6, .pose = components[0].pose * turn(wrong)});
  }
  const auto instances = fuse_views(views, {{"cup", {white_noise(), {}}}});
  ASSERT_EQ(instances.size(), 1U);
  EXPECT_LT((object_at().inverse() * instances[0].density[0].density.mean()).rotation().angle(),
            1e-6);
  EXPECT_GT(instances[0].density.weight(0), 0.99);
}

}  // namespace
}  // namespace posemix
