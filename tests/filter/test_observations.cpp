// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The multi-object filter with observations that are mixtures.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "filter/multi_object/detection_update.hpp"
#include "multi_object_scene.hpp"
#include "posemix/detector/default_noise.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::plain_settings;
using testing::pose;

const SE3d kSeen(SO3d::exp({2.8, 0.1, 0.0}), {0.05, -0.02, 0.9});
const SE3d kHalfTurn(SO3d::exp({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero());

DetectorNoise plain_noise(double clutter = 0.1) {
  return DetectorNoise({{.weight = 1.0 - clutter, .covariance = isotropic(2.0, 0.01)}},
                       {.weight = clutter, .volume_m3 = 1.0});
}

MultiObjectFilter filter_with(const DetectorNoise& noise, double camera_sd = 1e-4) {
  return {ConcentratedGaussian<SE3d>(SE3d(), isotropic(camera_sd, 1e-3 * camera_sd)),
          {{noise}},
          plain_settings()};
}

Observation observed(double first, const SE3d& a = kSeen, const SE3d& b = kSeen * kHalfTurn) {
  Observation observation;
  observation.components = {{.weight = first, .pose = a}, {.weight = 1.0 - first, .pose = b}};
  return observation;
}

/// Density of a detection at the pose, of an object at the hypothesis' place, in the tangent space
/// at it: written down anew from eq. (2) and (3).
double density(const MultiObjectFilter& filter, std::size_t h, const SE3d& seen,
               const Matrix6d& noise) {
  const auto relative = filter.relative(0, h);
  const Vector6d z = (seen * relative.mean().inverse()).log();
  const Matrix6d s = relative.covariance() + relative.mean().adjoint_congruence(noise);
  return std::exp(-0.5 * z.dot(s.inverse() * z)) /
         std::sqrt(std::pow(2.0 * std::numbers::pi, 6) * s.determinant());
}

TEST(Observations, OfOneComponentAreDetections) {
  MultiObjectFilter one = filter_with(default_detector_noise());
  MultiObjectFilter other = one;
  for (int k = 0; k < 5; ++k) {
    const SE3d seen = kSeen * SE3d::exp(0.02 * Vector6d::Constant(k % 3));
    one.predict_random_walk(isotropic(0.1, 0.001), 0.1);
    other.predict_random_walk(isotropic(0.1, 0.001), 0.1);
    one.update(0, seen);
    other.update(0, observation_of(seen));
    EXPECT_EQ(one.joint().covariance(), other.joint().covariance());
    EXPECT_EQ(one.mode_probability(0), other.mode_probability(0));
  }
}

TEST(Observations, StartOneHypothesisPerComponentWithItsWeight) {
  MultiObjectFilter filter = filter_with(plain_noise());
  EXPECT_TRUE(filter.update(0, observed(0.7)).started);
  const auto list = filter.hypotheses(0);
  ASSERT_EQ(list.size(), 2U);
  EXPECT_NEAR(list[0].probability / list[1].probability, 0.7 / 0.3, 1e-9);
  EXPECT_LT((list[0].pose.inverse() * kSeen).log().norm(), 1e-9);
  EXPECT_LT((list[1].pose.inverse() * kSeen * kHalfTurn).log().norm(), 1e-9);
  EXPECT_NEAR(list[0].probability + list[1].probability, 0.9, 1e-9);
}

TEST(Observations, WeighHypothesesByTheDensityOfTheMixture) {
  MultiObjectFilter filter = filter_with(plain_noise());
  filter.update(0, observed(0.7));
  const SE3d near = kSeen * SE3d::exp((Vector6d() << 0.02, 0.01, 0, 0.004, 0, 0).finished());
  const Observation second = observed(0.4, near, near * kHalfTurn);
  const double clutter = 0.1 / (8.0 * std::numbers::pi * std::numbers::pi);
  double expected[2];
  for (std::size_t h = 0; h < 2; ++h) {
    double sum = clutter;
    for (const ObservationComponent& c : second.components)
      sum += 0.9 * c.weight * density(filter, h, c.pose, isotropic(2.0, 0.01));
    expected[h] = filter.hypotheses(0)[h].probability * sum;
  }
  filter.update(0, second);
  const auto list = filter.hypotheses(0);
  ASSERT_EQ(list.size(), 2U);
  EXPECT_NEAR(list[0].probability / list[1].probability / (expected[0] / expected[1]), 1.0, 1e-6);
}

TEST(Observations, ClutterOfTheirOwnReplacesThatOfTheNoise) {
  MultiObjectFilter filter = filter_with(plain_noise(0.1));
  Observation doubtful = observed(0.5);
  doubtful.clutter = 0.8;
  filter.update(0, doubtful);
  EXPECT_NEAR(std::exp(filter.log_absent(0)), 0.8, 1e-9);
}

TEST(Observations, ACovarianceOfTheirOwnIsUsedAsTheNoiseSays) {
  const Matrix6d own = (Vector6d() << 1e-4, 4e-4, 9e-4, 1e-6, 4e-6, 9e-6).finished().asDiagonal();
  for (const auto use :
       {GivenCovariance::as_given, GivenCovariance::scaled, GivenCovariance::ignored}) {
    const DetectorNoise noise(plain_noise().components(), plain_noise().clutter(),
                              {.given_covariance = use});
    MultiObjectFilter filter = filter_with(noise);
    Observation observation = observation_of(kSeen);
    observation.components[0].covariance = own;
    filter.update(0, observation);
    const Matrix6d local =
        kSeen.inverse().adjoint_congruence(Matrix6d(filter.relative(0, 0).covariance()));
    const Matrix6d expected = use == GivenCovariance::ignored ? isotropic(2.0, 0.01) : own;
    EXPECT_LT((local - expected).norm(), 1e-4 * expected.norm()) << word_of(use);
  }
}

TEST(Observations, TheScaleOfTheirCovariancesIsLearnedUpAndDown) {
  for (const double true_scale : {0.3, 1.0, 4.0}) {
    RandomStream stream(3, 1);
    MultiObjectSettings settings;
    MultiObjectFilter filter(
        ConcentratedGaussian<SE3d>(SE3d(), isotropic(1e-4, 1e-6)),
        {{DetectorNoise({{.covariance = isotropic(2.0, 0.01)}}, {.weight = 0.05})}}, settings);
    const Matrix6d stated = isotropic(1.0, 0.004);
    for (int k = 0; k < 300; ++k) {
      Observation observation = observation_of(
          kSeen * SE3d::exp(testing::draw(true_scale * true_scale * stated, stream)));
      observation.components[0].covariance = stated;
      filter.predict_with_odometry(SE3d(), Matrix6d::Zero(), 0.1);
      filter.update(0, observation);
    }
    for (int axis = 0; axis < 6; ++axis)
      EXPECT_NEAR(std::log(filter.noise_scale(0)[axis] / true_scale), 0.0, 0.15)
          << "axis " << axis << " of scale " << true_scale;
  }
}

TEST(Observations, WeightsOfOneDetectorDoNotAddUpWithinItsModeTime) {
  const auto noise = [](double mode_time) {
    return DetectorNoise({{.covariance = isotropic(2.0, 0.01)}}, {.weight = 0.05, .volume_m3 = 1.0},
                         {.mode_time_s = mode_time});
  };
  const auto odds_after = [&](double mode_time) {
    MultiObjectFilter filter = filter_with(noise(mode_time));
    for (int k = 0; k < 50; ++k) {
      filter.predict_with_odometry(SE3d(), Matrix6d::Zero(), 0.05);
      filter.update(0, observed(0.6));
    }
    const auto list = filter.hypotheses(0);
    return std::log(list[0].probability / list[1].probability);
  };
  const double once = std::log(0.6 / 0.4);
  EXPECT_NEAR(odds_after(30.0), once, 0.1);
  EXPECT_GT(odds_after(0.0), 10.0 * once);
  // Two times as many observations in the same time tell the same.
  EXPECT_LT(odds_after(1.0), 4.0 * once);
  // The first counts once, and 2.45 s of a mode time of one second as much again and a half.
  EXPECT_NEAR(odds_after(1.0), (1.0 + 49.0 * -std::expm1(-0.05)) * once, 0.3 * once);
}

TEST(Observations, OfManyComponentsKeepEveryMode) {
  // Two hundred answers about the first mode, with more weight each, and few about the other.
  RandomStream stream(5, 1);
  Observation observation;
  for (int k = 0; k < 252; ++k) {
    const SE3d mode = k < 240 ? kSeen : kSeen * kHalfTurn;
    observation.components.push_back(
        {.weight = 1.0 / 252.0,
         .pose = mode * SE3d::exp(testing::draw(isotropic(0.5, 0.002), stream))});
  }
  MultiObjectFilter filter = filter_with(plain_noise());
  filter.update(0, observation);
  const auto list = filter.hypotheses(0);
  ASSERT_EQ(list.size(), 2U);
  EXPECT_NEAR(list[0].probability / list[1].probability, 20.0, 1e-6);
  filter.update(0, observation);
  EXPECT_EQ(filter.hypotheses(0).size(), 2U);
}

TEST(Observations, EveryComponentThatNobodyExplainsStartsAHypothesis) {
  MultiObjectFilter filter = filter_with(plain_noise());
  filter.update(0, kSeen);
  EXPECT_TRUE(filter.update(0, observed(0.6)).started);
  EXPECT_EQ(filter.hypotheses(0).size(), 2U);
  EXPECT_FALSE(filter.update(0, observed(0.6)).started);
  EXPECT_EQ(filter.leading(0), 0U);
}

TEST(Observations, FromACameraOnABodyAreThoseFromTheBody) {
  const SE3d body_camera = pose(0.3, -1.2, 0.4, 0.2, -0.1, 0.05);
  MultiObjectFilter body = filter_with(plain_noise(), 0.5);
  MultiObjectFilter rig = body;
  RandomStream stream(8, 1);
  for (int k = 0; k < 5; ++k) {
    const SE3d seen = kSeen * SE3d::exp(testing::draw(isotropic(2.0, 0.01), stream));
    body.update(0, observation_of(seen));
    rig.update(0, observation_of(body_camera.inverse() * seen), {.body_camera = body_camera});
    EXPECT_LT((body.joint().covariance() - rig.joint().covariance()).norm(), 1e-12);
    EXPECT_LT((body.camera().mean().inverse() * rig.camera().mean()).log().norm(), 1e-12);
  }
}

TEST(Observations, OfSeveralDetectorsUseTheNoiseOfEach) {
  const Matrix6d sharp = isotropic(0.5, 0.002);
  ObjectSensor sensor{plain_noise()};
  sensor.other_detectors.push_back(DetectorNoise({{.covariance = sharp}}, {.weight = 0.1}));
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), isotropic(1e-4, 1e-6)), {sensor},
                           plain_settings());
  filter.update(0, observation_of(kSeen), {.detector = 1});
  const Matrix6d local =
      kSeen.inverse().adjoint_congruence(Matrix6d(filter.relative(0, 0).covariance()));
  EXPECT_LT((local - sharp).norm(), 1e-3 * sharp.norm());
  EXPECT_THROW(filter.update(0, observation_of(kSeen), {.detector = 2}), InvalidInput);
}

TEST(Observations, SlowErrorsOfSeveralDetectorsAreOneErrorInTheirOwnUnits) {
  // A slow error that never decays: however often both detectors see the object, its pose stays as
  // uncertain as the smaller of their slow errors.
  const auto noise = [](double slow) {
    return DetectorNoise({{.covariance = isotropic(0.2, 0.001)}}, {.weight = 0.05},
                         {.slow = SlowError{.covariance = slow * slow * isotropic(1.0, 0.005)}});
  };
  ObjectSensor sensor{noise(2.0)};
  sensor.other_detectors.push_back(noise(1.0));
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), isotropic(1e-4, 1e-6)), {sensor},
                           plain_settings());
  for (int k = 0; k < 200; ++k)
    filter.update(0, observation_of(kSeen), {.detector = static_cast<std::size_t>(k % 2)});
  // Y_0 = X Exp(2 s), Y_1 = X Exp(s): the difference tells s, and with it X.
  const Matrix6d both = filter.relative(0, 0).covariance();
  EXPECT_LT(both(0, 0), 0.1 * isotropic(1.0, 0.005)(0, 0));
  MultiObjectFilter one(ConcentratedGaussian<SE3d>(SE3d(), isotropic(1e-4, 1e-6)), {sensor},
                        plain_settings());
  for (int k = 0; k < 200; ++k) one.update(0, observation_of(kSeen), {.detector = 1});
  EXPECT_NEAR(one.relative(0, 0).covariance()(0, 0) / isotropic(1.0, 0.005)(0, 0), 1.0, 0.05);
}

// Rounding may leave a covariance of the relative pose that is none.
TEST(Observations, TellNothingOfAnObjectWhoseCovarianceIsNone) {
  const ObjectSensor sensor{plain_noise()};
  internal::DetectionState state{.camera = SE3d(), .object = kSeen, .has_slow = false};
  const auto explained = [&] {
    return internal::explain(state, internal::weigh(observed(0.7), sensor, 1.0, {}), sensor);
  };
  EXPECT_LT(explained().clutter_probability, 1.0);
  EXPECT_NE(explained().log_weights, 0.0);
  state.covariance.block<6, 6>(internal::kObjectRow, internal::kObjectRow) = -Matrix6d::Identity();
  const internal::Explanation seen = explained();
  EXPECT_EQ(seen.clutter_probability, 1.0);
  EXPECT_EQ(seen.log_weights, 0.0);
  EXPECT_EQ(seen.log_evidence, sensor.noise.log_clutter_density());
  for (const internal::Innovation& one : seen.innovations) EXPECT_EQ(one.weight, 0.0);
}

TEST(Observations, AreRefusedWholeWhereTheyAreNotValid) {
  MultiObjectFilter filter = filter_with(plain_noise());
  filter.update(0, kSeen);
  const Matrix6d before = filter.relative(0, 0).covariance();
  Observation bad = observed(0.5);
  bad.components[1].weight = 0.1;
  EXPECT_THROW(filter.update(0, bad), InvalidInput);
  EXPECT_THROW(filter.update(1, observed(0.5)), InvalidInput);
  EXPECT_EQ(filter.relative(0, 0).covariance(), before);
}

TEST(Observations, OfAnObjectThatWasAddedStartIt) {
  MultiObjectFilter filter = filter_with(plain_noise());
  filter.update(0, kSeen);
  EXPECT_EQ(filter.add_object({plain_noise()}), 1U);
  EXPECT_FALSE(filter.leading(1).has_value());
  filter.update(1, observed(0.7));
  EXPECT_EQ(filter.hypotheses(1).size(), 2U);
  EXPECT_EQ(filter.joint().mean().size(), 3U);
}

}  // namespace
}  // namespace posemix
