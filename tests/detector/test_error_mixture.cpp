// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/error_mixture.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::relative_difference;
using testing::thrown_message;

const SE3d kEstimate(SO3d::exp({0.3, -1.0, 0.8}), {0.2, -0.1, 0.9});

Vector6d normal6(RandomStream& stream) {
  Eigen::VectorXd z(6);
  stream.fill_normal(z);
  return z;
}

/// 80 % sharp (1 deg, 2 mm; 20 mm of depth), 15 % turned by 30 deg about z, 5 % gross errors.
std::vector<Vector6d> simulated_errors(std::size_t count, std::uint64_t seed) {
  RandomStream stream(seed);
  Vector6d sd;
  sd << Eigen::Vector3d::Constant(radians(1.0)), 2e-3, 2e-3, 20e-3;
  std::vector<Vector6d> errors;
  for (std::size_t i = 0; i < count; ++i) {
    Vector6d error = sd.cwiseProduct(normal6(stream));
    const double kind = stream.uniform();
    if (kind < 0.15) error[2] += radians(30.0);
    if (kind > 0.95) {
      error.head<3>() *= 50.0;
      error.tail<3>() *= 40.0;
    }
    errors.push_back(error);
  }
  return errors;
}

TEST(SightError, DepthIsTheLastEntry) {
  const Eigen::Vector3d ray = kEstimate.translation().normalized();
  const SE3d farther(kEstimate.rotation(), kEstimate.translation() + 0.1 * ray);
  const Vector6d error = sight_error(kEstimate, farther);
  EXPECT_LT((error - Vector6d(-0.1 * Vector6d::Unit(5))).norm(), 1e-15);
  const SE3d turned(SO3d::exp(0.2 * ray).inverse() * kEstimate.rotation(), kEstimate.translation());
  EXPECT_LT((sight_error(kEstimate, turned) - Vector6d(0.2 * Vector6d::Unit(2))).norm(), 1e-15);
}

TEST(SightError, GoesThereAndBack) {
  RandomStream stream(1);
  for (int i = 0; i < 20; ++i) {
    const Vector6d error = 0.5 * normal6(stream);
    EXPECT_LT((sight_error(kEstimate, truth_with_error(kEstimate, error)) - error).norm(), 1e-12);
  }
}

TEST(ErrorMixture, DensityIsThatOfTheMixtureByTheVolume) {
  RandomStream stream(2);
  const ErrorMixture errors = fit_error_mixture(simulated_errors(500, 1), {}, stream).errors;
  for (int i = 0; i < 20; ++i) {
    const Vector6d error = errors.sample(stream);
    const double density = errors.mixture().log_density(Rnd<6>(error));
    EXPECT_NEAR(errors.log_density(error), density, 1e-10 * std::abs(density) + 1e-10);
    // |det J_l| = (2 sin(angle / 2) / angle)^2
    const double angle = error.head<3>().norm();
    EXPECT_NEAR(errors.log_pose_density(error),
                density - 2.0 * std::log(2.0 * std::sin(angle / 2.0) / angle),
                1e-10 * std::abs(density) + 1e-10);
  }
}

TEST(ErrorMixtureFit, FindsModeAndOutliers) {
  RandomStream stream(3);
  const ErrorMixtureFit fit = fit_error_mixture(simulated_errors(2000, 2), {}, stream);
  EXPECT_EQ(fit.components, 2U);
  const auto& mixture = fit.errors.mixture();
  ASSERT_EQ(mixture.size(), 3U);
  const std::size_t sharp = mixture.weight(0) > mixture.weight(1) ? 0 : 1;
  EXPECT_NEAR(mixture.weight(sharp), 0.8, 0.03);
  EXPECT_NEAR(mixture.weight(1 - sharp), 0.15, 0.03);
  EXPECT_NEAR(mixture.weight(2), 0.05, 0.01);
  EXPECT_NEAR(mixture[1 - sharp].density.mean().log()[2], radians(30.0), radians(0.5));
  const Matrix6d covariance = mixture[sharp].density.covariance();
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), radians(1.0), radians(0.1));
  EXPECT_NEAR(std::sqrt(covariance(5, 5)), 20e-3, 1e-3);
  EXPECT_NEAR(mixture[2].density.covariance()(0, 0), std::pow(radians(60.0), 2), 1e-12);
}

TEST(ErrorMixtureFit, ObjectiveNeverFalls) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    RandomStream stream(seed);
    const ErrorMixtureFit fit =
        fit_error_mixture(simulated_errors(150 * seed, seed), {.tolerance = 0.0}, stream);
    ASSERT_GT(fit.history.size(), 2U);
    for (std::size_t i = 1; i < fit.history.size(); ++i) {
      EXPECT_GE(fit.history[i], fit.history[i - 1] - 1e-9 * std::abs(fit.history[i]))
          << "seed " << seed << ", iteration " << i;
    }
  }
}

TEST(ErrorMixtureFit, TrimmingAndOneGaussian) {
  const std::vector<Vector6d> errors = simulated_errors(2000, 4);
  const std::vector<Vector6d> kept = trimmed_errors(errors, 5.0);
  EXPECT_NEAR(static_cast<double>(kept.size()) / 2000.0, 0.8, 0.03);
  const auto density = fit_error_gaussian(kept).mixture()[0].density;
  EXPECT_NEAR(std::sqrt(density.covariance()(5, 5)), 20e-3, 1.5e-3);
  Vector6d mean = Vector6d::Zero();
  for (const Vector6d& e : errors) mean += e / 2000.0;
  Matrix6d covariance = Matrix6d::Zero();
  for (const Vector6d& e : errors) covariance += (e - mean) * (e - mean).transpose() / 2000.0;
  const auto all = fit_error_gaussian(errors).mixture()[0].density;
  EXPECT_LT((all.mean().log() - mean).norm(), 1e-14);
  EXPECT_LT(relative_difference(all.covariance(), covariance), 1e-6);
}

TEST(ErrorMixtureFit, RefusesTooFewErrors) {
  RandomStream stream(1);
  const std::vector<Vector6d> few(7, Vector6d::Zero());
  EXPECT_EQ(thrown_message([&] { fit_error_mixture(few, {}, stream); }),
            "7 errors of an estimator, expected at least 8");
  EXPECT_EQ(thrown_message([&] { fit_error_gaussian(few); }),
            "7 errors of an estimator, expected at least 8");
}

}  // namespace
}  // namespace posemix
