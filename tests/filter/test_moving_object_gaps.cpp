// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// An object that moves and was not seen for a while: minutes, days, a year.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "filter/moving/prediction_reach.hpp"
#include "filter/precision.hpp"
#include "moving_object_scene.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::kFramePeriod_s;
using testing::MovingScene;
using testing::nees_of;
using testing::pose;
using testing::SceneNoise;
using testing::sds;

/// The defaults, a slower motion, one that hardly leaves its place, and one that may rest.
std::vector<MotionModels> motions() {
  return {{.models = {ConstantVelocityMotion{}}},
          {.models = {ConstantVelocityMotion{sds(0.3, 0.3)}}},
          {.models = {ConstantVelocityMotion{sds(1.0, 0.001)}}},
          {.models = {RandomWalkMotion{}}},
          {.models = {StaticMotion{}, ConstantVelocityMotion{sds(0.3, 0.3)}},
           .rates = Eigen::MatrixXd::Constant(2, 2, 0.1)}};
}

/// Ten detections, a gap after which the object lies elsewhere, and ten more. Returns the distance
/// to the first of them [m] and the NEES of the last per degree of freedom.
std::pair<double, double> after_a_gap(const MotionModels& models, double gap_s, double shift,
                                      std::uint64_t seed, bool predicts) {
  const DetectorNoise noise = SceneNoise{}.noise();
  MovingScene scene(seed, noise);
  MovingObjectFilter filter({noise}, models);
  const SE3d origin = pose(0, 0, 0, shift, 0.3 * shift, 0);
  std::pair<double, double> result;
  for (int k = 0; k < 20; ++k) {
    if (k == 10) {
      for (int i = 1; predicts && i < 20; ++i) filter.predict(scene.time_s + gap_s * i / 20);
      scene.put_down();
      scene.time_s += gap_s;
    }
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(scene.inlier()), exact_camera(origin * scene.camera));
    const MovingObjectEstimate now = filter.estimate();
    const SE3d truth = origin * scene.truth;
    const auto& world = now.hypotheses.front().world;
    if (k == 10) result.first = (world.mean().translation() - truth.translation()).norm();
    if (k == 19) {
      result.second = nees_of(truth, world) / 6.0;
      EXPECT_LT(now.lost_probability, 1e-3);
    }
  }
  return result;
}

// A hypothesis that is as wide as everything is no reason to look anywhere else than where the
// object is seen.
TEST(MovingObjectGaps, ItIsWhereItIsSeenHoweverLongItWasNot) {
  for (const MotionModels& models : motions()) {
    double nees = 0.0;
    int count = 0;
    for (const double gap_s : {10.0, 40.0, 60.0, 600.0, 3600.0, 86400.0, 2.6e6, 3e7}) {
      for (const double shift : {0.0, 40.0, 1000.0}) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
          const auto [distance, last] = after_a_gap(models, gap_s, shift, seed, seed % 2 == 0);
          EXPECT_LT(distance, 0.04) << gap_s << " s, " << shift << " m, seed " << seed;
          nees += last;
          ++count;
        }
      }
    }
    EXPECT_GT(nees / count, 0.6);
    EXPECT_LT(nees / count, 1.4);
  }
}

MotionState seen_state(double shift) {
  MotionState state{pose(0.3, 0.2, 0.5, shift, 0.3 * shift, 1.0), sds(0.4, 0.1),
                    Matrix12d::Identity()};
  state.covariance.topLeftCorner<6, 6>() =
      state.pose.adjoint_congruence(Matrix6d(isotropic(0.03, 0.003)));
  state.covariance.bottomRightCorner<6, 6>() *= 0.01;
  return state;
}

TEST(PredictionReach, IsAMillionTimesTheSharpestPositionOfTheDetector) {
  EXPECT_NEAR(internal::position_reach(SceneNoise{}.noise()), 3000.0, 1e-6);
  EXPECT_EQ(internal::position_reach(DetectorNoise({{1.0, isotropic(0.1, 1e-9)}})), 10.0);
}

TEST(PredictionReach, NothingChangesWithinIt) {
  const MotionState state = seen_state(0.0);
  for (const ObjectMotion& motion :
       {ObjectMotion(ConstantVelocityMotion{}), ObjectMotion(RandomWalkMotion{}),
        ObjectMotion(StaticMotion{})}) {
    for (const double dt : {0.0, 0.1, 20.0}) {
      const MotionPrediction whole = predict(state, motion, dt);
      const MotionPrediction within = internal::predicted_within(3000.0, state, motion, dt, SE3d());
      EXPECT_EQ(within.state.covariance, whole.state.covariance);
      EXPECT_EQ(within.state.pose.matrix(), whole.state.pose.matrix());
      EXPECT_EQ(within.jacobian, whole.jacobian);
      EXPECT_EQ(within.noise, whole.noise);
    }
  }
}

TEST(PredictionReach, ACovarianceBeyondItIsThatOfAShorterTimeAndOfASmallerTurn) {
  for (const double shift : {0.0, 40.0, 1000.0}) {
    for (const double dt : {60.0, 1e4, 2.6e6, 1e11}) {
      const MotionState state = seen_state(shift);
      const MotionPrediction after =
          internal::predicted_within(3000.0, state, ConstantVelocityMotion{}, dt, SE3d());
      const Matrix12d& p = after.state.covariance;
      ASSERT_TRUE(p.allFinite());
      const Matrix6d here = SE3d(SO3d(), -after.state.pose.translation())
                                .adjoint_congruence(Matrix6d(p.topLeftCorner<6, 6>()));
      EXPECT_NEAR(here.diagonal().head<3>().cwiseSqrt().maxCoeff(), 100.0, 1e-6);
      EXPECT_LE(here.diagonal().tail<3>().cwiseSqrt().maxCoeff(), 3000.0);
      EXPECT_GT(here.diagonal().tail<3>().cwiseSqrt().maxCoeff(), dt > 100.0 ? 2850.0 : 100.0);
      EXPECT_LT((after.state.pose.translation() - state.pose.translation()).norm(), 3000.0);
      // P = F P F^T + Q, which is definite, as a smoother needs them.
      const Matrix12d propagated =
          after.jacobian * state.covariance * after.jacobian.transpose() + after.noise;
      const Vector12d scale = p.diagonal().cwiseSqrt().cwiseInverse();
      EXPECT_LT((scale.asDiagonal() * (propagated - p) * scale.asDiagonal()).cwiseAbs().maxCoeff(),
                1e-9);
      EXPECT_EQ(Eigen::LLT<Matrix12d>(p).info(), Eigen::Success);
    }
  }
}

TEST(PredictionReach, WhatIsBeyondItAlreadyStays) {
  MotionState state = seen_state(0.0);
  state.covariance(3, 3) = 1e10;
  const MotionPrediction after =
      internal::predicted_within(3000.0, state, RandomWalkMotion{}, 100.0, SE3d());
  EXPECT_EQ(after.state.covariance.topLeftCorner(6, 6), state.covariance.topLeftCorner(6, 6));
}

}  // namespace
}  // namespace posemix
