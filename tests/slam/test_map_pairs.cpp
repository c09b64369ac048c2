// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "filter/moving_object_scene.hpp"
#include "posemix/testing/expect.hpp"
#include "slam/map_pairs.hpp"

/// Equations of docs/state.md against each other and against sampling.
namespace posemix {
namespace {

using internal::MapPair;
using internal::MapSide;
using internal::PairPrediction;
using internal::PairsFit;
using testing::isotropic;
using testing::pose;

const SE3d kWorlds = pose(0.1, -0.4, 0.8, 0.5, 0.2, -0.1);

/// A camera that sees four objects of which the last looks the same from all sides.
MultiObjectSlam map_of(std::uint64_t seed, const SE3d& world) {
  RandomStream stream(seed, 9);
  std::vector<ObjectModel> models;
  for (const char* id : {"a", "b", "c", "can"}) models.push_back({.id = id});
  models.back().symmetries = SymmetryGroup::turns({0.0, 0.0, 1.0}, 0);
  const Matrix6d start = isotropic(1.0, 0.01);
  MultiObjectSlam slam(PoseDensity(SE3d::exp(testing::draw(start, stream)) * world, start), models,
                       {}, {.model = MotionModel::still});
  for (int k = 0; k < 5; ++k) {
    FrameInput input{.dt = 1.0, .detections = {}};
    for (int j = 0; j < 4; ++j) {
      const SE3d place = pose(0.2 * j, 0.3, -0.1 * j, 0.15 * j, 0.1 * j * j, 0.8);
      input.detections.push_back(place * SE3d::exp(testing::draw(isotropic(2.0, 0.01), stream)));
    }
    slam.step(input);
  }
  return slam;
}

/// The leading hypotheses of the objects.
std::vector<MapPair> leading_pairs(const MultiObjectSlam& a, const MultiObjectSlam& b) {
  std::vector<MapPair> pairs;
  for (std::size_t j = 0; j < 4; ++j)
    pairs.push_back({j, *a.filter().leading(j), j, *b.filter().leading(j)});
  return pairs;
}

TEST(MapPairs, WhatIsLeftOutIsWhatTheOthersPredict) {
  const MultiObjectSlam before = map_of(1, SE3d());
  const MultiObjectSlam after = map_of(2, kWorlds);
  const MapSide old_map(before, 0.0);
  const MapSide now(after, 0.0);
  const std::vector<MapPair> pairs = leading_pairs(before, after);
  const PairsFit fit(old_map, now, kWorlds, pairs);
  ASSERT_TRUE(fit.is_solved());
  const std::vector<double> left_out = fit.left_out();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    std::vector<MapPair> others = pairs;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const PairsFit rest(old_map, now, kWorlds, others);
    const PairPrediction predicted = rest.predict(pairs[k]);
    // Up to where each is linearised.
    EXPECT_NEAR(left_out[k], predicted.squared_distance, 0.02 * predicted.squared_distance + 0.02);
    EXPECT_NEAR(fit.log_evidence() - rest.log_evidence(), predicted.log_density, 0.15);
  }
}

TEST(MapPairs, OnePairSaysWhereItIsAndNothingElse) {
  const MultiObjectSlam before = map_of(1, SE3d());
  const MultiObjectSlam after = map_of(2, kWorlds);
  const MapSide old_map(before, 0.0);
  const MapSide now(after, 0.0);
  const MapPair pair = leading_pairs(before, after)[0];
  const PairsFit fit(old_map, now, SE3d(), {pair});
  const SE3d& x = old_map.hypotheses(0)[pair.old_hypothesis].pose;
  const SE3d& y = now.hypotheses(0)[pair.new_hypothesis].pose;
  EXPECT_TRUE((fit.new_old() * x).is_approx(y, 1e-9));
  EXPECT_EQ(fit.left_out(), std::vector<double>{0.0});
  // The object is where the new run alone has it.
  const auto relocated = fit.relocated(0, pair.old_hypothesis);
  EXPECT_TRUE(relocated.world.mean().is_approx(y, 1e-9));
  const Matrix6d& known = now.hypotheses(0)[pair.new_hypothesis].covariance;
  EXPECT_LT((relocated.world.covariance() - known).norm(), 1e-9 * known.norm());
}

TEST(MapPairs, AnAngleAboutAnAxisOfSymmetryTellsNothing) {
  const MultiObjectSlam before = map_of(1, SE3d());
  const MultiObjectSlam after = map_of(2, kWorlds);
  const MapSide old_map(before, 0.0);
  const MapSide now(after, 0.0);
  const MapPair can = leading_pairs(before, after)[3];
  const PairsFit fit(old_map, now, kWorlds, {can});
  ASSERT_TRUE(fit.is_solved());
  // About the can's axis T has the variances of two uniform angles, across it those of the poses.
  const SE3d& y = now.hypotheses(3)[can.new_hypothesis].pose;
  const Matrix6d along = y.inverse().adjoint_congruence(fit.covariance());
  EXPECT_NEAR(along(2, 2), 2.0 * std::numbers::pi * std::numbers::pi / 3.0, 0.1);
  EXPECT_LT(along(0, 0), 0.03);
  EXPECT_LT(along(1, 1), 0.03);
}

}  // namespace
}  // namespace posemix
