// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The motion models of objects: Jacobians by differences, noise by simulation of the stochastic
// differential equations, composition of steps.
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/base/random.hpp"
#include "posemix/filter/object_motion.hpp"
#include "posemix/testing/expect.hpp"
#include "scenario.hpp"

namespace posemix {
namespace {

using testing::pose;
using testing::thrown_message;

const SE3d kFrameMotion = pose(0.3, -0.4, 0.2, 0.3, 0.1, -0.2);

Vector6d vector6(double a, double b, double c, double d, double e, double f) {
  return (Vector6d() << a, b, c, d, e, f).finished();
}

const Vector6d kSds = vector6(0.5, 0.9, 0.7, 0.2, 0.4, 0.3);

std::vector<ObjectMotion> all_models() {
  return {StaticMotion{},
          PutDownMotion{},
          RandomWalkMotion{kSds, MotionFrame::object},
          RandomWalkMotion{kSds, MotionFrame::world},
          ConstantVelocityMotion{kSds, MotionFrame::object},
          ConstantVelocityMotion{kSds, MotionFrame::world},
          AttachedMotion{0, kSds}};
}

std::string label(const ObjectMotion& motion) {
  const auto frame = twist_frame(motion);
  return std::string(name_of(motion)) + (frame == MotionFrame::world ? " (world)"
                                         : frame                     ? " (object)"
                                                                     : "");
}

MotionState moving_state(const ObjectMotion& motion, RandomStream& stream) {
  MotionState state;
  state.pose = pose(0.7, -1.2, 0.4, 0.5, -0.3, 1.1);
  if (twist_frame(motion)) state.twist = vector6(0.9, -0.5, 1.3, 0.4, -0.7, 0.2);
  const Eigen::MatrixXd all = testing::correlated_covariance(2, stream);
  state.covariance = all;
  if (!twist_frame(motion)) {
    state.covariance.bottomRows<6>().setZero();
    state.covariance.rightCols<6>().setZero();
  }
  return state;
}

MotionState moved_by(const MotionState& state, const Vector12d& by) {
  MotionState result = state;
  result.pose = SE3d::exp(Vector6d(by.head<6>())) * state.pose;
  result.twist += by.tail<6>();
  return result;
}

Vector12d difference(const MotionState& to, const MotionState& from) {
  Vector12d d;
  d << (to.pose * from.pose.inverse()).log(), to.twist - from.twist;
  return d;
}

/// The Jacobian of a map of states, by the five-point rule.
template <class Map>
Matrix12d numeric_state_jacobian(const MotionState& at, const Map& map) {
  constexpr double h = 1e-3;
  const MotionState origin = map(at);
  Matrix12d jacobian;
  for (Eigen::Index i = 0; i < 12; ++i) {
    const auto value = [&](double s) {
      return difference(map(moved_by(at, s * Vector12d::Unit(i))), origin);
    };
    jacobian.col(i) = (value(-2 * h) - 8 * value(-h) + 8 * value(h) - value(2 * h)) / (12 * h);
  }
  return jacobian;
}

TEST(ObjectMotion, JacobiansAreDerivativesOfTheMean) {
  RandomStream stream(1, 2);
  for (const ObjectMotion& motion : all_models()) {
    for (const double dt : {0.0, 0.04, 0.8, 3.0}) {
      const MotionState state = moving_state(motion, stream);
      const MotionPrediction next = predict(state, motion, dt, kFrameMotion);
      Matrix12d expected = numeric_state_jacobian(state, [&](const MotionState& from) {
        return predict(from, motion, dt, kFrameMotion).state;
      });
      EXPECT_TRUE(testing::matrices_near(next.jacobian, expected, 1e-8)) << label(motion) << dt;
    }
  }
}

TEST(ObjectMotion, ChangesOfTheModelHaveTheirJacobians) {
  RandomStream stream(2, 2);
  for (const ObjectMotion& from : all_models()) {
    for (const ObjectMotion& to : all_models()) {
      const MotionState state = moving_state(from, stream);
      Matrix12d jacobian;
      const MotionState changed = as_state_of(state, from, to, &jacobian);
      const Matrix12d expected = numeric_state_jacobian(
          state, [&](const MotionState& other) { return as_state_of(other, from, to); });
      EXPECT_TRUE(testing::matrices_near(jacobian, expected, 1e-8)) << label(from) << label(to);
      EXPECT_EQ(changed.pose.matrix(), state.pose.matrix());
      if (twist_frame(from) && twist_frame(to)) {
        const MotionState back = as_state_of(changed, to, from);
        EXPECT_TRUE(testing::matrices_near(back.twist, state.twist, 1e-12));
        EXPECT_TRUE(testing::matrices_near(back.covariance, state.covariance, 1e-12));
      }
    }
  }
}

TEST(ObjectMotion, BeginsToMoveWithTheSdsOfTheStart) {
  const ConstantVelocityMotion to{.start_sds = kSds};
  const MotionState state = as_state_of({}, StaticMotion{}, to);
  EXPECT_TRUE(state.twist.isZero(0.0));
  EXPECT_EQ(Vector6d(state.covariance.diagonal().tail<6>()), Vector6d(kSds.cwiseAbs2()));
}

TEST(ObjectMotion, TwoHalfStepsAreOneStep) {
  RandomStream stream(3, 2);
  for (const ObjectMotion& motion : all_models()) {
    for (const double dt : {0.1, 2.0, 20.0}) {
      MotionState state = moving_state(motion, stream);
      const SE3d half_motion = SE3d::exp(0.5 * kFrameMotion.log());
      const MotionPrediction one = predict(state, motion, dt, kFrameMotion);
      const MotionPrediction first = predict(state, motion, 0.5 * dt, half_motion);
      const MotionPrediction second = predict(first.state, motion, 0.5 * dt, half_motion);
      EXPECT_TRUE(second.state.pose.is_approx(one.state.pose, 1e-11)) << label(motion);
      EXPECT_LT(testing::relative_difference(second.state.covariance, one.state.covariance), 1e-10)
          << label(motion) << dt;
      EXPECT_LT(testing::relative_difference(second.jacobian * first.jacobian, one.jacobian), 1e-10)
          << label(motion) << dt;
    }
  }
}

/// The state after `dt` seconds of the stochastic differential equation, in `steps` Euler steps of
/// the noise, each with the exact motion in between.
MotionState simulated(MotionState state, const ObjectMotion& motion, double dt, int steps,
                      RandomStream& stream) {
  const double h = dt / steps;
  const auto noise = [&](const Vector6d& sds) {
    Eigen::VectorXd white(6);
    stream.fill_normal(white);
    return Vector6d(std::sqrt(h) * sds.cwiseProduct(white));
  };
  const auto step = [&](MotionFrame frame, const Vector6d& by) {
    if (frame == MotionFrame::object) {
      state.pose = state.pose * SE3d::exp(by);
    } else {
      state.pose = SE3d(SO3d::exp(by.head<3>()) * state.pose.rotation(),
                        state.pose.translation() + by.tail<3>());
    }
  };
  for (int k = 0; k < steps; ++k) {
    if (const auto* walk = std::get_if<RandomWalkMotion>(&motion))
      step(walk->frame, noise(walk->sds));
    if (const auto* velocity = std::get_if<ConstantVelocityMotion>(&motion)) {
      const Vector6d change = noise(velocity->acceleration_sds);
      // The mean twist over the step.
      step(velocity->frame, Vector6d(h * (state.twist + 0.5 * change)));
      state.twist += change;
    }
  }
  return state;
}

// 20000 paths: the error of a variance is 1 % of it, that of a covariance 0.7 % of the two sds.
TEST(ObjectMotion, NoiseIsThatOfTheStochasticDifferentialEquation) {
  constexpr int kPaths = 20000;
  constexpr double dt = 0.5;
  RandomStream stream(4, 2);
  for (ObjectMotion motion : all_models()) {
    if (std::holds_alternative<AttachedMotion>(motion)) continue;
    // Small noise, for which the linearised equation holds.
    if (auto* walk = std::get_if<RandomWalkMotion>(&motion)) walk->sds *= 0.02;
    if (auto* velocity = std::get_if<ConstantVelocityMotion>(&motion))
      velocity->acceleration_sds *= 0.02;
    MotionState state = moving_state(motion, stream);
    state.covariance.setZero();
    const MotionPrediction next = predict(state, motion, dt);
    Matrix12d second = Matrix12d::Zero();
    for (int path = 0; path < kPaths; ++path) {
      const Vector12d d = difference(simulated(state, motion, dt, 25, stream), next.state);
      second += d * d.transpose() / kPaths;
    }
    const Vector12d sds = next.noise.diagonal().cwiseSqrt();
    for (Eigen::Index i = 0; i < 12; ++i) {
      for (Eigen::Index k = 0; k < 12; ++k)
        EXPECT_NEAR(second(i, k), next.noise(i, k), 0.04 * sds[i] * sds[k] + 1e-20)
            << label(motion) << i << k;
    }
  }
}

TEST(ObjectMotion, OfAnAttachedObjectIsThatOfItsFrame) {
  RandomStream stream(5, 2);
  const AttachedMotion attached{};
  const MotionState state = moving_state(attached, stream);
  const SE3d before = pose(0.1, 0.2, 0.3, 1.0, 2.0, 3.0);
  const SE3d after = pose(-0.4, 0.9, 0.3, 1.3, 1.0, 2.0);
  const MotionPrediction next = predict(state, attached, 0.5, after * before.inverse());
  const SE3d in_grip = before.inverse() * state.pose;
  EXPECT_TRUE((after.inverse() * next.state.pose).is_approx(in_grip, 1e-12));
  // The covariance in the frame stays.
  const Matrix6d was = before.inverse().adjoint_congruence(state.covariance.topLeftCorner<6, 6>());
  const Matrix6d is =
      after.inverse().adjoint_congruence(next.state.covariance.topLeftCorner<6, 6>());
  EXPECT_TRUE(testing::matrices_near(is, was, 1e-12));
}

TEST(ObjectMotion, GoesStraightInTheWorldAndOnAScrewInTheObjectsFrame) {
  MotionState state;
  state.twist = vector6(0, 0, 1.0, 1.0, 0, 0);
  const MotionPrediction straight =
      predict(state, ConstantVelocityMotion{.frame = MotionFrame::world}, 3.14159265358979);
  EXPECT_TRUE(straight.state.pose.translation().isApprox(Eigen::Vector3d(3.14159265358979, 0, 0)));
  const MotionPrediction circle =
      predict(state, ConstantVelocityMotion{.frame = MotionFrame::object}, 3.14159265358979);
  EXPECT_TRUE(circle.state.pose.translation().isApprox(Eigen::Vector3d(0, 2.0, 0), 1e-9));
  EXPECT_NEAR(straight.state.pose.rotation().angle(), circle.state.pose.rotation().angle(), 1e-12);
}

TEST(ObjectMotion, RefusesWhatIsOutOfRange) {
  EXPECT_EQ(thrown_message([] { validate(PutDownMotion{.jump_rate = -1.0}); }),
            "put_down: jump_rate is -1, expected a number that is not negative");
  EXPECT_NE(thrown_message([] { validate(PutDownMotion{.volume_m3 = 0.0}); }), "");
  EXPECT_NE(thrown_message([] { validate(RandomWalkMotion{.sds = -kSds}); }), "");
  EXPECT_NE(thrown_message([] { validate(ConstantVelocityMotion{.start_sds = -kSds}); }), "");
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_NE(thrown_message([&] { validate(AttachedMotion{.slip_sds = infinite * kSds}); }), "");
  EXPECT_NE(thrown_message([] { predict({}, StaticMotion{}, -0.1); }), "");
  MotionState broken;
  broken.twist[2] = std::nan("");
  EXPECT_NE(thrown_message([&] { predict(broken, ConstantVelocityMotion{}, 0.1); }), "");
}

}  // namespace
}  // namespace posemix
