// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Saved states that hold what no filter can: each is refused, and says what was expected.
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "filter/moving/state_fields.hpp"
#include "joint_gaussian_scene.hpp"
#include "moving_object_scene.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix::internal {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// What is said of a state that holds this; empty where it is as it should be.
template <class T>
std::string refusal(const T& x) {
  return posemix::testing::thrown_message([&] { StateFields<T>::validate(x); });
}

std::string damaged(const std::string& expected) {
  return "the state is damaged: expected " + expected;
}

/// A camera whose pose on the body is estimated, and objects of which two are passive.
JointGaussian joint_with_passive_objects() {
  RandomStream stream(31);
  const posemix::testing::PairScene scene = posemix::testing::pair_scene(4, stream);
  JointGaussian joint = scene.joint;
  std::vector<bool> keeps(joint.size(), false);
  for (const std::size_t object : {scene.objects[0], scene.objects[1]}) {
    for (std::size_t k = 0; k < joint.blocks_of(object); ++k) keeps[object + k] = true;
  }
  joint.rebase(keeps);
  return joint;
}

auto& blocks_in(JointGaussian& joint) {
  return std::get<0>(StateFields<JointGaussian>::tie(joint));
}

auto& base_in(JointGaussian& joint) { return std::get<4>(StateFields<JointGaussian>::tie(joint)); }

TEST(StateFields, OfAJointGaussianAreAccepted) {
  RandomStream stream(31);
  EXPECT_EQ(refusal(posemix::testing::pair_scene(4, stream).joint), "");
  const JointGaussian joint = joint_with_passive_objects();
  ASSERT_LT(joint.active(), joint.size());
  EXPECT_EQ(refusal(joint), "");
}

TEST(StateFields, TheCameraHasTheFirstCoordinates) {
  JointGaussian joint = joint_with_passive_objects();
  std::swap(blocks_in(joint)[0].at, blocks_in(joint)[1].at);
  EXPECT_EQ(refusal(joint), damaged("the camera and its rig first"));
}

TEST(StateFields, EveryCoordinateIsOfOneBlock) {
  JointGaussian joint = joint_with_passive_objects();
  blocks_in(joint)[1].at = blocks_in(joint)[2].at;
  EXPECT_EQ(refusal(joint), damaged("coordinates of one block each"));
}

TEST(StateFields, ABaseIsSquareAndFinite) {
  const JointGaussian joint = joint_with_passive_objects();
  JointGaussian wide = joint;
  Eigen::MatrixXd base = *base_in(wide);
  const Eigen::Index n = base.rows();
  base.conservativeResize(n, n + 1);
  base.rightCols<1>().setZero();
  base_in(wide) = std::make_shared<const Eigen::MatrixXd>(base);
  EXPECT_EQ(refusal(wide), damaged("a base"));

  JointGaussian not_finite = joint;
  base = *base_in(not_finite);
  base(0, n - 1) = kNotANumber;
  base_in(not_finite) = std::make_shared<const Eigen::MatrixXd>(base);
  EXPECT_EQ(refusal(not_finite), damaged("a base"));
}

/// A filter of one object with two models, which was detected twice.
MovingObjectFilter moving_filter() {
  using posemix::testing::SceneNoise;
  posemix::testing::MovingScene scene(3, SceneNoise{}.noise());
  MovingObjectFilter filter({SceneNoise{}.noise()}, {.models = {StaticMotion{}, PutDownMotion{}}});
  for (int k = 0; k < 2; ++k) {
    scene.advance(StaticMotion{}, 0.1);
    filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
  }
  return filter;
}

MovingObjectState& state_in(MovingObjectFilter& filter) {
  return *std::get<0>(StateFields<MovingObjectFilter>::tie(filter));
}

/// The part of a type of the posterior.
template <class T>
T& part_of(MovingObjectFilter& filter) {
  return std::get<T&>(StateFields<MovingObjectState>::tie(state_in(filter)));
}

TEST(StateFields, OfAMovingObjectAreAccepted) {
  MovingObjectFilter filter = moving_filter();
  EXPECT_EQ(refusal(state_in(filter)), "");
}

TEST(StateFields, AMovingObjectHasAWeightForEveryModelAndMode) {
  const std::string expected = damaged("a weight for every model and mode");
  MovingObjectFilter filter = moving_filter();
  ModeWeights& lost = part_of<ModeWeights>(filter);
  const ModeWeights right = lost;
  lost.right.conservativeResize(right.right.rows() + 1, Eigen::NoChange);
  EXPECT_EQ(refusal(state_in(filter)), expected);
  lost = right;
  lost.right.conservativeResize(Eigen::NoChange, right.right.cols() + 1);
  EXPECT_EQ(refusal(state_in(filter)), expected);
  lost = right;
  lost.runs.clear();
  EXPECT_EQ(refusal(state_in(filter)), expected);
  lost = right;
  part_of<std::vector<MovingHypothesis>>(filter).front().weights.right.conservativeResize(
      1, Eigen::NoChange);
  EXPECT_EQ(refusal(state_in(filter)), expected);
}

TEST(StateFields, TheConstantErrorOfACameraHasACovariance) {
  MovingObjectFilter filter = moving_filter();
  Matrix6d& constant = part_of<Matrix6d>(filter);
  constant = Matrix6d::Identity();
  EXPECT_EQ(refusal(state_in(filter)), "");
  constant(2, 2) = -1.0;
  EXPECT_EQ(refusal(state_in(filter)), damaged("a covariance that is positive semi-definite"));
  constant(2, 2) = kNotANumber;
  EXPECT_EQ(refusal(state_in(filter)), damaged("a covariance that is finite"));
}

}  // namespace
}  // namespace posemix::internal
