// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "scenario.hpp"

/// What rounding leaves of the linearized update, P - W W^T or Joseph's form.
namespace posemix {
namespace {

using testing::correlated_covariance;
using testing::draw;
using testing::isotropic;
using testing::pose;
using testing::three_poses;

/// The posterior covariance of a camera and two objects, both detected, in long double and Joseph's
/// form.
Eigen::MatrixXd joseph(const Eigen::MatrixXd& prior, const std::array<Matrix6d, 2>& noise) {
  using Exact = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Exact p = prior.cast<long double>();
  Exact h = Exact::Zero(12, 18);
  h.leftCols(6) << -Exact::Identity(6, 6), -Exact::Identity(6, 6);
  h.rightCols(12) = Exact::Identity(12, 12);
  Exact r = Exact::Zero(12, 12);
  for (Eigen::Index j = 0; j < 2; ++j)
    r.block(6 * j, 6 * j, 6, 6) = noise[static_cast<std::size_t>(j)].cast<long double>();
  const Exact s = h * p * h.transpose() + r;
  const Exact k = s.llt().solve(h * p).transpose();
  const Exact rest = Exact::Identity(18, 18) - k * h;
  return Exact(rest * p * rest.transpose() + k * r * k.transpose()).cast<double>();
}

/// The error of a covariance as it is seen from the camera, in standard deviations.
double error_from_camera(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& expected) {
  Eigen::MatrixXd from_camera = Eigen::MatrixXd::Zero(12, 18);
  from_camera.leftCols(6) << -Matrix6d::Identity(), -Matrix6d::Identity();
  from_camera.rightCols(12).setIdentity();
  const Eigen::LLT<Eigen::MatrixXd> factor(from_camera * expected * from_camera.transpose());
  const Eigen::MatrixXd error = from_camera * (covariance - expected) * from_camera.transpose();
  const Eigen::MatrixXd half = factor.matrixL().solve(error);
  return Eigen::MatrixXd(factor.matrixL().solve(half.transpose())).norm();
}

TEST(UpdatePrecision, KeepsItsDigitsHoweverWideThePriorIs) {
  RandomStream stream(42);
  const PoseStackd truth = three_poses();
  const Eigen::MatrixXd covariance_before = correlated_covariance(3, stream);
  const Matrix6d r = isotropic(3.0, 0.008);
  const auto detected = [&](std::size_t object) {
    return truth[0].inverse() * truth[object] * SE3d::exp(draw(r, stream));
  };
  Matrix6d correlated = r;
  correlated(0, 4) = correlated(4, 0) = 0.7 * std::sqrt(r(0, 0) * r(4, 4));
  Eigen::MatrixXd of_objects = covariance_before;
  of_objects.leftCols(6).setZero();
  of_objects.topRows(6).setZero();
  const Eigen::MatrixXd of_camera =
      Eigen::VectorXd(
          (Eigen::VectorXd(18) << Vector6d::Constant(1e-6), Eigen::VectorXd::Zero(12)).finished())
          .asDiagonal();
  for (const Matrix6d& covariance : {r, correlated}) {
    const DetectorNoise noise({{1.0, covariance}});
    const std::vector<const NoiseComponent*> components(2, &noise.components().front());
    for (const double wide : {0.01, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 1e3, 1e4, 1e5, 1e6}) {
      const std::vector<Detection> detections{{1, detected(1), &noise}, {2, detected(2), &noise}};
      std::array<Matrix6d, 2> in_world;
      for (std::size_t j = 0; j < 2; ++j)
        in_world[j] = innovation(truth, detections[j], *components[j]).noise;
      // Where the objects alone are uncertain nothing is lost; what camera and objects have in
      // common has its own rounding.
      const auto check = [&](const Eigen::MatrixXd& prior, double tolerance) {
        const UpdateResult result = update(Hypothesis(truth, prior), detections, components);
        ASSERT_TRUE(result.ok);
        const Eigen::MatrixXd expected = joseph(prior, in_world);
        const Eigen::MatrixXd& found = result.posterior.covariance();
        EXPECT_LT((found - expected).norm(), 1e-14 * expected.norm()) << wide;
        EXPECT_LT(error_from_camera(found, expected), tolerance) << wide;
      };
      check(of_camera + wide * wide * of_objects, 1e-12);
      check(wide * wide * covariance_before, 1e-12 + 1e-13 * wide * wide);
    }
  }
}

/// Each detector is far finer than the one before, so that what one leaves is wide for the next.
TEST(UpdatePrecision, KeepsItsDigitsWhereDetectorsAreFinerByAndBy) {
  using Exact = long double;
  for (const double finer : {30.0, 1e3, 3e4}) {
    const Hypothesis prior(PoseStackd(std::vector<SE3d>(4)),
                           Eigen::VectorXd((Eigen::VectorXd(24) << Vector6d::Ones(),
                                            Eigen::VectorXd::Constant(18, 1e-26))
                                               .finished())
                               .asDiagonal());
    std::vector<DetectorNoise> noises;
    Exact information = 1.0L;
    for (double variance = 1.0 / finer; noises.size() < 3; variance /= finer) {
      Vector6d variances = Vector6d::Constant(1e3);
      variances[3] = variance;
      noises.emplace_back(std::vector<NoiseComponent>{{1.0, variances.asDiagonal()}});
      information += 1.0L / variance;
    }
    std::vector<Detection> detections;
    std::vector<const NoiseComponent*> components;
    for (std::size_t j = 0; j < 3; ++j) {
      detections.push_back({j + 1, SE3d(), &noises[j]});
      components.push_back(&noises[j].components().front());
    }
    const UpdateResult result = update(prior, detections, components);
    ASSERT_TRUE(result.ok);
    const auto expected = static_cast<double>(1.0L / information);
    EXPECT_NEAR(result.posterior.covariance()(3, 3) / expected, 1.0, 1e-6) << finer;
  }
}

/// Isotropic variances of rotation [rad^2] and position [m^2].
Matrix6d variances(double rotation, double position) {
  Vector6d both;
  both << Eigen::Vector3d::Constant(rotation), Eigen::Vector3d::Constant(position);
  return both.asDiagonal();
}

/// Whether a filter took a detection; if not, it is bit for bit as it was.
bool takes_or_stays(GaussianSumFilter& filter, const Detection& detection) {
  const Posterior before = filter.posterior();
  try {
    if (!filter.update(std::span(&detection, 1)).failed[0]) return true;
  } catch (const InvalidInput& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("which double precision holds"), std::string::npos)
        << refusal.what();
  }
  const Hypothesis& after = filter.posterior()[0].density;
  EXPECT_EQ(after.covariance(), before[0].density.covariance());
  for (std::size_t i = 0; i < after.mean().size(); ++i)
    EXPECT_EQ(after.mean()[i].matrix(), before[0].density.mean()[i].matrix());
  return false;
}

/// A stray detection puts a camera of unknown rotation 40 to 370 km away, where the covariances
/// hold few digits and about half of the next detections would fail.
TEST(UpdatePrecision, ADetectionThatIsNotTakenFarAwayLeavesEveryBit) {
  const DetectorNoise noise({{1.0, variances(1e-6, 6e-8), NoiseFrame::camera}});
  GaussianSumSettings settings;
  settings.update = UpdateRule::linearized;
  settings.noise_use = NoiseUse::joint;
  const PoseStackd start(std::vector<SE3d>{pose(0, 0, 0, -1, -1, -0.24)});
  int not_taken = 0;
  for (const double far : {1e5, 1e6, 1e7}) {
    for (const double aside : {-1.0, 0.5, 1.0}) {
      for (const double turn : {0.0, 1.0, 2.5}) {
        GaussianSumFilter filter(Posterior({{0.0, Hypothesis(start, variances(2.35, 2.2e-7))}}),
                                 settings);
        filter.add_object(pose(0, 0, 0, 0, 0, 0.001), noise);
        filter.predict([](Hypothesis h) {
          return predict_with_odometry(std::move(h), SE3d(), variances(1e-4, 2e-4));
        });
        takes_or_stays(filter, {1, pose(turn, 0, 0, far, aside * far, far), &noise});
        if (!takes_or_stays(filter, {1, pose(0, 0, 0, 0.4, 0.4, 0.4), &noise})) ++not_taken;
      }
    }
  }
  EXPECT_GT(not_taken, 0);
}

/// Seen from a camera that odometry put 100 km away, an object is as wrong as the start was turned
/// times that far. Where a detector claims centimetres then, its noise is lost in the rounding, and
/// the update left covariances that were none.
TEST(UpdatePrecision, WhatWasLeftFarBehindIsSeenAgainOnlyWhereRoundingHoldsTheNoise) {
  const DetectorNoise noise({{1.0, variances(2.5e-3, 1e-4), NoiseFrame::object}});
  const PoseStackd start(std::vector<SE3d>{pose(1, -1, 2, 0, 0, 0)});
  for (const bool is_turned : {false, true}) {
    GaussianSumFilter filter(
        Posterior({{0.0, Hypothesis(start, variances(is_turned ? 41.0 : 1e-6, 4.7))}}), {});
    filter.add_object(pose(0, 0.1, 0, 0.2, 0.6, 1.7), noise);
    filter.predict([](Hypothesis h) {
      return predict_with_odometry(std::move(h), pose(0, 0, 0, -3e4, 3e4, 9e4),
                                   variances(1e-4, 1e-4));
    });
    EXPECT_EQ(takes_or_stays(filter, {1, pose(0, 0, 0.3, 3e4, -3e4, -9e4), &noise}), !is_turned);
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(filter.posterior()[0].density.covariance()).info(),
              Eigen::Success);
  }
}

}  // namespace
}  // namespace posemix
