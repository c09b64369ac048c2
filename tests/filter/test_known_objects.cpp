// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Objects whose pose is known before they are seen, and a camera that is lost.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "multi_object_scene.hpp"
#include "posemix/detector/default_noise.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::plain_settings;

const SE3d kFlip(SO3d::exp({0.0, std::numbers::pi / 2.0, 0.0}), Eigen::Vector3d::Zero());

DetectorNoise tag_noise(double mode_time_s = 0.0) {
  return DetectorNoise({{.weight = 0.99, .covariance = isotropic(0.5, 0.005)}},
                       {.weight = 0.01, .volume_m3 = 100.0}, {.mode_time_s = mode_time_s});
}

ObjectPrior prior_at(const SE3d& world, double probability = 0.95) {
  return {ConcentratedGaussian<SE3d>(world, world.adjoint_congruence(isotropic(0.5, 0.005))),
          probability};
}

/// A camera that may be anywhere about `near`.
ConcentratedGaussian<SE3d> anywhere(const SE3d& near) {
  Matrix6d covariance = Matrix6d::Identity() * kUniformRotationVariance;
  covariance.bottomRightCorner<3, 3>() = 25.0 * Eigen::Matrix3d::Identity();
  const SE3d position(SO3d(), near.translation());
  return {near, position.adjoint_congruence(covariance)};
}

Observation observed_alone(const SE3d& camera_object, double first = 1.0) {
  Observation observation = observation_of(camera_object);
  if (first < 1.0) {
    observation.components.front().weight = first;
    observation.components.push_back({.weight = 1.0 - first, .pose = camera_object * kFlip});
  }
  return observation;
}

double apart(const SE3d& a, const SE3d& b) { return (a.inverse() * b).log().norm(); }

TEST(KnownObjects, HaveAHypothesisFromTheBeginning) {
  MultiObjectFilter filter({SE3d(), isotropic(1.0, 0.01)}, {}, plain_settings());
  const SE3d world(SO3d::exp({0.3, 0.1, -0.4}), {3.0, -1.0, 2.0});
  EXPECT_EQ(filter.add_object({tag_noise()}, prior_at(world, 0.9)), 0U);
  ASSERT_EQ(filter.hypotheses(0).size(), 1U);
  EXPECT_LT(apart(filter.hypotheses(0)[0].pose, world), 1e-12);
  EXPECT_NEAR(filter.mode_probability(0), 0.9, 1e-12);
  EXPECT_TRUE(filter.hypotheses(0)[0].covariance.isApprox(prior_at(world).world.covariance()));
  EXPECT_TRUE(filter.hypotheses(0)[0].cross_covariance.isZero(0.0));
  EXPECT_THROW(filter.add_object({tag_noise()}, prior_at(world, 0.0)), InvalidInput);
  EXPECT_THROW(filter.add_object({tag_noise()}, prior_at(world, 1.5)), InvalidInput);
  EXPECT_EQ(filter.object_count(), 1U);
}

TEST(KnownObjects, OfAWrongSurveyAreLetGoOf) {
  const SE3d world(SO3d(), {0.0, 0.0, 2.0});
  const SE3d truth(SO3d::exp({0.0, 0.0, 0.6}), {0.4, 0.1, 2.1});
  MultiObjectFilter filter({SE3d(), isotropic(0.1, 0.001)}, {}, plain_settings());
  filter.add_object({tag_noise()}, prior_at(world));
  for (int k = 0; k < 30; ++k) {
    filter.predict_random_walk(isotropic(0.01, 1e-4), 0.1);
    filter.update(0, observed_alone(truth));
  }
  const auto leading = filter.leading(0);
  ASSERT_TRUE(leading.has_value());
  EXPECT_LT(apart(filter.hypotheses(0)[*leading].pose, truth), 0.05);
  EXPECT_LT(apart(filter.camera().mean(), SE3d()), 0.05);
}

TEST(LostCamera, IsFoundFromAKnownObject) {
  const SE3d world(SO3d::exp({0.3, 0.1, -0.4}), {30.0, -10.0, 2.0});
  const SE3d camera(SO3d::exp({-1.5, 1.2, 1.0}), {27.0, -8.0, 1.5});
  MultiObjectFilter filter(anywhere(SE3d(SO3d(), {30.0, -8.0, 0.0})), {}, plain_settings());
  filter.add_object({tag_noise()}, prior_at(world));
  filter.update(0, observed_alone(camera.inverse() * world));
  filter.update(0, observed_alone(camera.inverse() * world));
  EXPECT_LT(apart(filter.camera().mean(), camera), 0.02);
  const Eigen::Matrix3d rotation = filter.camera().covariance().topLeftCorner<3, 3>();
  EXPECT_LT(rotation.trace(), 0.01);
}

// The gains of a noise that is typical are damped with odometry; that would move what is known.
TEST(LostCamera, IsFoundWithOdometryAndTheDefaultNoise) {
  const SE3d world(SO3d(), {5.0, 0.0, 1.0});
  const SE3d camera(SO3d(), {5.0, 0.0, 0.0});
  MultiObjectSettings settings;
  settings.has_odometry = true;
  MultiObjectFilter filter(anywhere(SE3d(SO3d(), {5.5, 0.0, 1.0})), {}, settings);
  filter.add_object({default_detector_noise()}, prior_at(world));
  for (int k = 0; k < 30; ++k) {
    filter.predict_with_odometry(SE3d(), isotropic(0.1, 0.001), 0.1);
    filter.update(0, observed_alone(camera.inverse() * world));
  }
  EXPECT_LT((filter.camera().mean().translation() - camera.translation()).norm(), 0.2);
  EXPECT_LT(apart(filter.hypotheses(0)[*filter.leading(0)].pose, world), 0.05);
}

// An unknown object that is seen while the camera is lost turns with it when it is found.
TEST(LostCamera, TakesNewObjectsAlong) {
  const SE3d known(SO3d::exp({0.3, 0.1, -0.4}), {4.0, -1.0, 2.0});
  const SE3d fresh(SO3d::exp({0.0, 1.0, 0.2}), {3.0, 0.5, 2.5});
  const SE3d camera(SO3d::exp({-1.5, 1.2, 1.0}), {2.0, 1.0, 1.5});
  MultiObjectFilter filter(anywhere(SE3d()), {{tag_noise()}}, plain_settings());
  filter.add_object({tag_noise()}, prior_at(known));
  for (int k = 0; k < 3; ++k) filter.update(0, observed_alone(camera.inverse() * fresh));
  for (int k = 0; k < 3; ++k) filter.update(1, observed_alone(camera.inverse() * known));
  EXPECT_LT(apart(filter.camera().mean(), camera), 0.02);
  EXPECT_LT(apart(filter.hypotheses(0)[*filter.leading(0)].pose, fresh), 0.05);
}

/// But for the error of the start, which is all that they share.
TEST(LostCamera, IsIndependentOfTheMapAfterALongPause) {
  const Matrix6d start = isotropic(1.0, 0.01);
  MultiObjectFilter filter({SE3d(), start}, {{tag_noise()}}, plain_settings());
  const SE3d object(SO3d(), {0.0, 0.0, 1.0});
  filter.update(0, observed_alone(object));
  const Matrix6d before = filter.hypotheses(0)[0].covariance;
  const double position = filter.camera().covariance()(5, 5);
  filter.predict_random_walk(isotropic(300.0, 2.0), 30.0);
  EXPECT_TRUE(filter.hypotheses(0)[0].cross_covariance.isApprox(0.99 * start));
  EXPECT_TRUE(filter.hypotheses(0)[0].covariance.isApprox(before));
  EXPECT_NEAR(filter.camera().covariance()(0, 0), kUniformRotationVariance + 0.99 * start(0, 0),
              1e-12);
  EXPECT_NEAR(filter.camera().covariance()(5, 5), position + 4.0, 1e-6);

  // It is found from its map.
  const SE3d camera(SO3d::exp({1.0, -2.0, 0.5}), {1.5, 1.0, -2.0});
  for (int k = 0; k < 3; ++k) filter.update(0, observed_alone(camera.inverse() * object));
  EXPECT_LT(apart(filter.camera().mean(), camera), 0.05);
}

// What the position loses is the noise's, and nothing is rounding of a rotation about the origin.
TEST(LostCamera, IsWhereItWasHoweverWideTheNoiseIs) {
  const SE3d camera(SO3d::exp({0.4, -1.0, 0.3}), {-0.3, 12.0, 4.0});
  const SE3d to_camera(SO3d(), -camera.translation());
  for (const double wide : {1e1, 1e4, 1e6, 1e8}) {
    MultiObjectFilter filter({camera, isotropic(1.0, 0.01)}, {{tag_noise()}}, plain_settings());
    const auto position = [&] {
      const Matrix6d near = to_camera.adjoint_congruence(filter.camera().covariance());
      return Eigen::Matrix3d(near.bottomRightCorner<3, 3>());
    };
    const Eigen::Matrix3d before = position();
    Matrix6d q = isotropic(3.0, 0.02);
    q(1, 1) = wide * wide;
    filter.predict_random_walk(q, 1.0);
    EXPECT_LT((position() - before - 4e-4 * Eigen::Matrix3d::Identity()).norm(), 1e-9) << wide;
    EXPECT_NO_THROW(ConcentratedGaussian<SE3d>(camera, filter.camera().covariance())) << wide;
  }
}

// A known tag with two poses places the camera at two places, and the one with more weight leads
// until another view decides.
TEST(LostCamera, HasAStateForEveryComponent) {
  const SE3d world(SO3d::exp({0.3, 0.1, -0.4}), {4.0, -1.0, 2.0});
  const SE3d camera(SO3d::exp({-0.5, 0.6, 1.0}), {2.0, 1.0, 1.5});
  MultiObjectFilter filter(anywhere(SE3d()), {}, plain_settings());
  filter.add_object({tag_noise(5.0)}, prior_at(world));
  Observation wrong = observed_alone(camera.inverse() * world, 0.3);  // the wrong pose has 0.7
  filter.update(0, wrong);
  const auto cameras = filter.camera_mixture();
  ASSERT_GE(cameras.size(), 2U);
  bool right = false;
  for (const auto& component : cameras.components())
    right = right || apart(component.density.mean(), camera) < 0.3;
  EXPECT_TRUE(right);
  // Nearer, the right pose is clear.
  filter.predict_random_walk(isotropic(1.0, 0.01), 0.1);
  filter.update(0, observed_alone(camera.inverse() * world, 0.999));
  EXPECT_LT(apart(filter.camera().mean(), camera), 0.1);
}

// What the weights say more clearly than before counts at once, repeated weights hardly.
TEST(Weights, CountOnceAndMoreWhereTheyAreClearer) {
  const SE3d object(SO3d::exp({0.2, 0.0, 0.0}), {0.0, 0.0, 1.0});
  const auto probability_of = [&](std::initializer_list<double> firsts) {
    MultiObjectFilter filter({SE3d(), isotropic(0.1, 0.001)}, {{tag_noise(100.0)}},
                             plain_settings());
    for (const double first : firsts) {
      filter.predict_random_walk(isotropic(1e-3, 1e-5), 0.05);
      filter.update(0, observed_alone(object, first));
    }
    double right = 0.0;
    for (const ObjectHypothesis& h : filter.hypotheses(0))
      if (apart(h.pose, object) < 0.3) right += h.probability;
    return right;
  };
  const double once = probability_of({0.7});
  EXPECT_NEAR(probability_of({0.7, 0.7, 0.7, 0.7, 0.7, 0.7}), once, 0.03);
  EXPECT_GT(probability_of({0.7, 0.99}), 0.95);
  EXPECT_LT(probability_of({0.7, 0.01}), 0.3);
}

}  // namespace
}  // namespace posemix
