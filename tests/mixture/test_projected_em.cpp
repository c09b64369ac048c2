// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "em_draws.hpp"
#include "posemix/density/projected_moments.hpp"
#include "posemix/mixture/em.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::draws;
using testing::log_likelihood;
using testing::Projected;
using testing::three_poses;
using testing::thrown_message;
using testing::worst_fall;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Standard deviations of the rotation angle in degrees, small ones in radians: |u| is half of it.
Eigen::Matrix3d covariance_of_angles(double x, double y, double z) {
  return (0.5 * kDegree * Eigen::Vector3d(x, y, z)).cwiseAbs2().asDiagonal();
}

/// A wide axis of 30 degrees keeps its width to sampling noise, while the second
/// moment, which is the paper's M-step, has lost a tenth.
TEST(ProjectedEm, RecoversWideAxes) {
  RandomStream stream(3);
  const Projected<SO3d> truth(SO3d::exp({0.3, -0.2, 0.5}), covariance_of_angles(30, 5, 10));
  const auto samples = draws(Mixture<Projected<SO3d>>({{0.0, truth}}), 20000, stream);
  const auto fit = fit_mixture<Projected<SO3d>>(samples, {}, {}, stream);
  EXPECT_EQ(fit.status, EmStatus::converged);
  const auto& density = fit.mixture[0].density;
  EXPECT_NEAR(2.0 * std::sqrt(density.covariance()(0, 0)) / kDegree, 30.0, 0.6);
  EXPECT_LT((density.mean().inverse() * truth.mean()).log().norm(), 0.5 * kDegree);
  double second_moment = 0.0;
  for (const SO3d& sample : samples) {
    second_moment += std::pow(density.coordinates(sample)[0], 2) / 20000.0;
  }
  EXPECT_LT(2.0 * std::sqrt(second_moment) / kDegree, 28.0);
}

TEST(ProjectedEm, PicksTheNumberOfComponentsByBic) {
  RandomStream stream(6);
  const auto truth = three_poses<Projected<SE3d>>();
  const auto samples = draws(truth, 1500, stream);
  const EmSettings settings{.components = 4, .restarts = 2};
  const auto selection = fit_mixture_by_bic<Projected<SE3d>>(samples, {}, settings, stream);
  ASSERT_EQ(selection.fits.size(), 4U);
  ASSERT_EQ(selection.best, 2U);
  const auto& fit = selection.fits[2];
  EXPECT_EQ(fit.status, EmStatus::converged);
  EXPECT_EQ(fit.starts, 2);
  EXPECT_EQ(fit.parameters, 3U * 27U + 2U);
  // Twice the gain over the truth is chi-squared with as many degrees of freedom: 83 +- 13.
  EXPECT_NEAR(2.0 * (fit.log_likelihood - log_likelihood(truth, samples)), 83.0, 52.0);
}

/// Uniform rotations have the density 1 / (8 pi^2), which many wide components approximate. A
/// higher likelihood is noise, about half a unit for every parameter; a lower one is due to the
/// limit on P_uu, up to 41 for one component.
TEST(ProjectedEm, OfUniformRotationsDoesNotDiverge) {
  constexpr std::size_t kCount = 1000;
  const double uniform = -1000.0 * std::log(8.0 * std::numbers::pi * std::numbers::pi);
  for (const std::size_t components : {1U, 4U}) {
    RandomStream stream(5, components);
    std::vector<SO3d> samples;
    for (std::size_t i = 0; i < kCount; ++i) {
      Eigen::VectorXd q(4);
      stream.fill_normal(q);
      samples.push_back(SO3d::from_quaternion(Eigen::Quaterniond(q[0], q[1], q[2], q[3])));
    }
    const auto fit = fit_mixture<Projected<SO3d>>(
        samples, {}, {.components = components, .restarts = 2}, stream);
    EXPECT_NE(fit.status, EmStatus::degenerate);
    EXPECT_LE(worst_fall(fit.history), 1e-9);
    EXPECT_LT(fit.log_likelihood, uniform + 2.0 * static_cast<double>(fit.parameters));
    EXPECT_GT(fit.log_likelihood, uniform - 60.0);
  }
}

/// A sample at an angle of pi from a tangent point has density zero there, and causes no NaN.
TEST(ProjectedEm, SamplesAtTheEquatorHaveNoDensity) {
  RandomStream stream(4);
  const Mixture<Projected<SE3d>> truth(
      {{0.0, Projected<SE3d>(SE3d(), Matrix6d(0.01 * Matrix6d::Identity()))},
       {0.0, Projected<SE3d>(SE3d(SO3d::exp({0.5, 0, 0}), Eigen::Vector3d(1, 0, 0)),
                             Matrix6d(0.04 * Matrix6d::Identity()))}});
  auto samples = draws(truth, 200, stream);
  const SE3d opposite(SO3d::from_quaternion(Eigen::Quaterniond(0, 1, 0, 0)),
                      Eigen::Vector3d::Zero());
  samples.push_back(opposite);
  EXPECT_EQ(truth[0].density.log_density(opposite), -std::numeric_limits<double>::infinity());

  EmRow log;
  const EmSettings settings;
  EmModel<Projected<SE3d>>::Worker worker(truth[0].density, settings);
  worker.log_density(EmCoordinates{std::span<const SE3d>(samples)}, 0, samples.size(), log);
  EXPECT_EQ(log[200], -std::numeric_limits<double>::infinity());

  const auto fit =
      fit_mixture<Projected<SE3d>>(samples, {}, {.components = 2}, stream, std::optional(truth));
  EXPECT_TRUE(std::isfinite(fit.log_likelihood));
  EXPECT_LE(worst_fall(fit.history), 1e-9);
  const auto alone = fit_mixture<Projected<SE3d>>(
      samples, {}, {.components = 1}, stream,
      std::optional(Mixture<Projected<SE3d>>({{0.0, truth[0].density}})));
  for (const double value : alone.history) EXPECT_FALSE(std::isnan(value));
  EXPECT_TRUE(alone.mixture[0].density.covariance().allFinite());
}

TEST(ProjectedEm, KeepsSpreadsWithinTheirBounds) {
  RandomStream stream(10);
  const auto samples = draws(three_poses<Projected<SE3d>>(), 500, stream);
  Eigen::VectorXd unit(6);
  unit << 1, 1, 1, 0.1, 0.2, 0.3;
  for (const bool diagonal : {false, true}) {
    const EmSettings settings{.components = 2,
                              .restarts = 2,
                              .diagonal = diagonal,
                              .unit = unit,
                              .min_sd = 0.3,
                              .max_sd = 0.6};
    const auto fit = fit_mixture<Projected<SE3d>>(samples, {}, settings, stream);
    EXPECT_LE(worst_fall(fit.history), 1e-9);
    for (const auto& component : fit.mixture.components()) {
      const Matrix6d& p = component.density.covariance();
      const Eigen::Matrix3d uu = 4.0 * p.topLeftCorner<3, 3>();
      const Eigen::Matrix3d given =
          p.bottomRightCorner<3, 3>() -
          p.bottomLeftCorner<3, 3>() * p.topLeftCorner<3, 3>().inverse() * p.topRightCorner<3, 3>();
      const Eigen::Vector3d scale = unit.tail<3>().cwiseInverse();
      const Eigen::Matrix3d scaled = scale.asDiagonal() * given * scale.asDiagonal();
      for (const Eigen::Matrix3d& part : {uu, scaled}) {
        const Eigen::Vector3d values =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(part).eigenvalues();
        EXPECT_GE(values[0], 0.09 * (1.0 - 1e-9));
        EXPECT_LE(values[2], 0.36 * (1.0 + 1e-9));
      }
      EXPECT_EQ(p.isDiagonal(0.0), diagonal);
    }
  }
}

/// Within bounds the covariance has the samples' moment in the axes that are free, and the
/// likelihood falls to either side.
TEST(ProjectedEm, BoundedCovarianceIsTheMostLikely) {
  const Eigen::Vector3d moments(0.02, 0.08, 0.3);
  const EmSettings settings{.min_sd = 0.4, .max_sd = 1.0};
  const Eigen::Matrix3d fit =
      internal::bounded_projected_covariance(Eigen::Matrix3d(moments.asDiagonal()), settings);
  EXPECT_NEAR(fit(0, 0), 0.04, 1e-15);
  EXPECT_NEAR(fit(2, 2), 0.25, 1e-15);
  EXPECT_NEAR(projected_moments(Eigen::Vector3d::Zero(), fit).second_moment(1, 1), 0.08, 1e-13);
  const auto expected_log_likelihood = [&](const Eigen::Matrix3d& s) {
    return -projected_log_normalizer(Eigen::Vector3d::Zero(), s) -
           0.5 * (s.diagonal().array().log() + moments.array() / s.diagonal().array()).sum();
  };
  for (const double step : {-1e-4, 1e-4}) {
    Eigen::Matrix3d other = fit;
    other(1, 1) += step;
    EXPECT_LT(expected_log_likelihood(other), expected_log_likelihood(fit));
  }
}

TEST(ProjectedEm, AStartBeyondTheBoundsKeepsWhatItsTranslationTellsOfItsRotation) {
  RandomStream stream(14);
  const Projected<SE3d> wide(SE3d(), testing::random_covariance<SE3d>(2.0, stream));
  const auto slope = [](const Matrix6d& p) -> Eigen::Matrix3d {
    return p.bottomLeftCorner<3, 3>() * p.topLeftCorner<3, 3>().inverse();
  };
  const EmSettings settings{.min_sd = 0.1, .max_sd = 0.5};
  const Matrix6d bounded = EmModel<Projected<SE3d>>::prepared(wide, settings).covariance();
  const auto spread = [](const Matrix6d& p) { return p.diagonal().head<3>().sum(); };
  EXPECT_LT(spread(bounded), spread(wide.covariance()));
  EXPECT_LT((slope(bounded) - slope(wide.covariance())).norm(), 1e-12);
  EXPECT_EQ(bounded, bounded.transpose());
  EmSettings diagonal = settings;
  diagonal.diagonal = true;
  EXPECT_TRUE(EmModel<Projected<SE3d>>::prepared(wide, diagonal).covariance().isDiagonal(0.0));
}

TEST(ProjectedEm, CovariancesAreExactlySymmetric) {
  RandomStream stream(15);
  for (int k = 0; k < 20; ++k) {
    const Eigen::Matrix3d moment = testing::random_covariance<SO3d>(0.5, stream);
    const Eigen::Matrix3d fitted = internal::bounded_projected_covariance(moment, {});
    EXPECT_EQ(fitted, fitted.transpose());
  }
}

TEST(ProjectedEm, FixedMeansStay) {
  RandomStream stream(9);
  const auto samples = draws(three_poses<Projected<SE3d>>(), 300, stream);
  const EmSettings settings{.components = 2, .restarts = 2, .fixed_means = true, .diagonal = true};
  const auto fit = fit_mixture<Projected<SE3d>>(samples, {}, settings, stream);
  for (const auto& component : fit.mixture.components()) {
    EXPECT_TRUE(component.density.mean().is_approx(SE3d(), 0.0));
    EXPECT_TRUE(component.density.covariance().isDiagonal(0.0));
  }
  EXPECT_EQ(fit.parameters, 13U);
}

TEST(ProjectedEm, MovesAStartToTheChartAtItsMode) {
  RandomStream stream(12);
  const auto samples = draws(three_poses<Projected<SE3d>>(), 100, stream);
  Vector6d mean = Vector6d::Zero();
  mean << 0.1, -0.2, 0.3, 0.1, 0.2, 0.8;
  const Projected<SE3d> aside(SO3d::exp({0.1, 0, 0}), mean, Matrix6d(Matrix6d::Identity()));
  const auto fit =
      fit_mixture<Projected<SE3d>>(samples, {}, {.max_iterations = 1}, stream,
                                   std::optional(Mixture<Projected<SE3d>>({{0.0, aside}})));
  const Mixture<Projected<SE3d>> at_mode({{0.0, change_chart_to_mode(aside)}});
  EXPECT_NEAR(fit.history.front(), log_likelihood(at_mode, samples), 1e-9);
  EXPECT_TRUE(fit.mixture[0].density.tangent_mean().head<3>().isZero(0.0));
}

TEST(ProjectedEm, RefusesUnequalUnitsOfRotation) {
  RandomStream stream(13);
  const auto samples = draws(three_poses<Projected<SE3d>>(), 30, stream);
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(6);
  unit[1] = 2.0;
  EXPECT_EQ(
      thrown_message([&] { fit_mixture<Projected<SE3d>>(samples, {}, {.unit = unit}, stream); }),
      "EM: the units of rotation are 1, 2 and 1, expected equal ones for full covariances of "
      "projected Gaussians");
}

}  // namespace
}  // namespace posemix
