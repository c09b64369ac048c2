// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "live/transforms.hpp"

namespace posemix::internal {
namespace {

SE3d along_x(double metres) { return SE3d(SO3d(), {metres, 0.0, 0.0}); }

TEST(FrameTree, BetweenTwoPosesItIsOnTheGeodesic) {
  FrameTree tree(10.0);
  const SE3d turned(SO3d::exp({0.0, 0.0, 0.4}), {1.0, 0.0, 0.0});
  tree.add("odom", "base", 0, SE3d());
  tree.add("odom", "base", 100000000, turned);
  const auto half = tree.at("odom", "base", 50000000, 0.2);
  ASSERT_TRUE(half);
  EXPECT_NEAR(half->rotation().angle(), 0.2, 1e-12);
  EXPECT_TRUE((*half * *half).is_approx(turned, 1e-12));
  EXPECT_FALSE(tree.at("odom", "base", 50000000, 0.05)) << "the gap is too long";
  EXPECT_FALSE(tree.at("odom", "base", 100000001, 0.2)) << "after the last";
  EXPECT_FALSE(tree.at("odom", "base", -1, 0.2)) << "before the first";
}

TEST(FrameTree, GoesUpToTheSharedFrameAndDownAgain) {
  FrameTree tree(10.0);
  tree.add("base", "left", std::nullopt, along_x(-1.0));
  tree.add("base", "right", std::nullopt, along_x(2.0));
  tree.add("odom", "base", 5, along_x(100.0));
  EXPECT_TRUE(tree.at("left", "right", 7, 0.0)->is_approx(along_x(3.0), 1e-12))
      << "odom -> base is not needed";
  EXPECT_TRUE(tree.at("odom", "right", 5, 0.0)->is_approx(along_x(102.0), 1e-12));
  EXPECT_FALSE(tree.at("left", "elsewhere", 5, 0.0));
  EXPECT_EQ(tree.root("left"), "odom");
  EXPECT_EQ(tree.parent("odom"), "");
}

TEST(FrameTree, AnotherParentTakesTheChildAway) {
  FrameTree tree(10.0);
  tree.add("a", "child", std::nullopt, along_x(1.0));
  tree.add("b", "child", std::nullopt, along_x(2.0));
  EXPECT_FALSE(tree.at("a", "child", 0, 0.0));
  EXPECT_TRUE(tree.at("b", "child", 0, 0.0));
}

TEST(FrameTree, ARingIsNoWay) {
  FrameTree tree(10.0);
  tree.add("a", "b", std::nullopt, along_x(1.0));
  tree.add("b", "a", std::nullopt, along_x(1.0));
  EXPECT_FALSE(tree.at("c", "a", 0, 0.0));
  EXPECT_EQ(tree.root("a"), "a");
}

TEST(FrameTree, PosesOlderThanTheWindowAreForgotten) {
  FrameTree tree(1.0);
  tree.add("odom", "base", 0, SE3d());
  tree.add("odom", "base", 900000000, SE3d());
  EXPECT_TRUE(tree.at("odom", "base", 0, 1.0));
  tree.add("odom", "base", 1900000000, SE3d());
  EXPECT_FALSE(tree.at("odom", "base", 0, 1.0));
  // The clock has jumped back: what is of the time before has no meaning.
  tree.add("odom", "base", 100, SE3d());
  EXPECT_FALSE(tree.at("odom", "base", 1900000000, 1.0));
  EXPECT_TRUE(tree.at("odom", "base", 100, 1.0));
}

TEST(FrameTree, WhatHoldsForAllTimesOutlivesAJumpOfTheClock) {
  FrameTree tree(1.0);
  tree.add("base", "camera", std::nullopt, along_x(1.0));
  tree.add("odom", "base", 0, SE3d());
  tree.clear();
  EXPECT_TRUE(tree.at("base", "camera", 0, 1.0));
  EXPECT_FALSE(tree.at("odom", "base", 0, 1.0));
}

}  // namespace
}  // namespace posemix::internal
