// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "em_draws.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::draws;
using testing::Gaussian;
using testing::Projected;
using testing::random_mixture;
using testing::relative_difference;
using testing::three_poses;
using testing::thrown_message;

TEST(Em, OfOneComponentOnVectorsIsMeanAndCovariance) {
  RandomStream stream(3);
  const auto samples = draws(random_mixture<Rnd<3>>(3, 2.0, 1.0, stream), 200, stream);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& sample : samples) mean += sample.value() / 200.0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& sample : samples) {
    covariance += (sample.value() - mean) * (sample.value() - mean).transpose() / 200.0;
  }
  const auto fit = fit_mixture<Gaussian<Rnd<3>>>(samples, {}, {}, stream);
  EXPECT_EQ(fit.status, EmStatus::converged);
  EXPECT_LT((fit.mixture[0].density.mean().value() - mean).norm(), 1e-12);
  EXPECT_LT(relative_difference(fit.mixture[0].density.covariance(), covariance), 1e-12);
  EXPECT_EQ(fit.parameters, 9U);
  EXPECT_NEAR(fit.bic, 9.0 * std::log(200.0) - 2.0 * fit.log_likelihood, 1e-9);
}

TEST(Em, RecoversAMixtureOfPoses) {
  RandomStream stream(5);
  const Mixture<Gaussian<SE3d>> truth = three_poses<Gaussian<SE3d>>();
  constexpr double kCount = 8000;
  const auto samples = draws(truth, static_cast<std::size_t>(kCount), stream);
  const EmSettings settings{.components = 3, .restarts = 4};
  const auto fit = fit_mixture<Gaussian<SE3d>>(samples, {}, settings, stream);
  EXPECT_EQ(fit.status, EmStatus::converged);
  EXPECT_EQ(fit.starts, 4);
  for (const auto& component : truth.components()) {
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      const auto gap = [&](std::size_t j) {
        return (fit.mixture[j].density.mean() * component.density.mean().inverse()).log().norm();
      };
      if (gap(i) < gap(k)) k = i;
    }
    const double share = std::exp(component.log_weight);
    EXPECT_NEAR(fit.mixture.weight(k), share, 4.0 * std::sqrt(share * (1 - share) / kCount));
    const Vector6d sd = component.density.covariance().diagonal().cwiseSqrt();
    const Vector6d found = fit.mixture[k].density.covariance().diagonal().cwiseSqrt();
    const Vector6d gap = (fit.mixture[k].density.mean() * component.density.mean().inverse()).log();
    for (Eigen::Index i = 0; i < 6; ++i) {
      EXPECT_NEAR(found[i], sd[i], 4.0 * sd[i] / std::sqrt(2.0 * share * kCount));
      EXPECT_NEAR(gap[i], 0.0, 4.0 * sd[i] / std::sqrt(share * kCount));
    }
  }
}

TEST(Em, PicksTheNumberOfComponentsByBic) {
  RandomStream stream(6);
  const auto samples = draws(three_poses<Gaussian<SE3d>>(), 1500, stream);
  const EmSettings settings{.components = 4, .restarts = 2};
  const auto selection = fit_mixture_by_bic<Gaussian<SE3d>>(samples, {}, settings, stream);
  ASSERT_EQ(selection.fits.size(), 4U);
  EXPECT_EQ(selection.best, 2U);
}

template <class D>
class EmOfPoses : public ::testing::Test {};
using Poses = ::testing::Types<Gaussian<SE3d>, Projected<SE3d>>;
TYPED_TEST_SUITE(EmOfPoses, Poses);

TYPED_TEST(EmOfPoses, AWeightCountsSamples) {
  RandomStream stream(8);
  const auto start = std::optional(three_poses<TypeParam>());
  const auto samples = draws(*start, 300, stream);
  std::vector<double> weights(samples.size());
  std::vector<SE3d> repeated;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    weights[i] = static_cast<double>(i % 3);
    repeated.insert(repeated.end(), i % 3, samples[i]);
  }
  // So few that rounding does not decide when either of them ends.
  const EmSettings settings{.components = 3, .max_iterations = 5, .tolerance = 0.0};
  const auto a = fit_mixture<TypeParam>(samples, weights, settings, stream, start);
  const auto b = fit_mixture<TypeParam>(repeated, {}, settings, stream, start);
  EXPECT_EQ(a.status, EmStatus::max_iterations);
  EXPECT_EQ(b.status, EmStatus::max_iterations);
  EXPECT_NEAR(a.log_likelihood, b.log_likelihood, 1e-8);
  EXPECT_NEAR(a.bic, b.bic, 1e-8);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(a.mixture[k].density.mean().is_approx(b.mixture[k].density.mean(), 1e-9));
  }
}

TYPED_TEST(EmOfPoses, SaysThatAComponentCollapsed) {
  RandomStream stream(12);
  std::vector<Component<TypeParam>> start = three_poses<TypeParam>().components();
  auto samples = draws(Mixture<TypeParam>(start), 200, stream);
  const std::vector<SE3d> same(20, SE3d::exp(Vector6d::Constant(-1.5)));
  samples.insert(samples.end(), same.begin(), same.end());
  start.push_back({0.0, TypeParam(same.front(), Matrix6d(1e-4 * Matrix6d::Identity()))});
  const auto fit = fit_mixture<TypeParam>(samples, {}, {.components = 4, .min_sd = 1e-4}, stream,
                                          std::optional(Mixture<TypeParam>(std::move(start))));
  EXPECT_EQ(fit.status, EmStatus::degenerate);
}

TEST(Em, TellsConcentricComponentsApart) {
  RandomStream stream(9);
  const SE3d centre;
  const Matrix6d narrow = 0.01 * Matrix6d::Identity();
  Matrix6d wide = narrow;
  wide(2, 2) = 1.0;
  const std::vector<double> shares{0.6, 0.4};
  const auto truth = Mixture<Gaussian<SE3d>>::from_weights(
      shares, {Gaussian<SE3d>(centre, narrow), Gaussian<SE3d>(centre, wide)});
  const auto samples = draws(truth, 5000, stream);
  const EmSettings settings{.components = 2, .restarts = 3, .fixed_means = true, .diagonal = true};
  const auto fit = fit_mixture<Gaussian<SE3d>>(samples, {}, settings, stream);
  const std::size_t sharp = fit.mixture[0].density.covariance()(2, 2) < 0.1 ? 0 : 1;
  EXPECT_NEAR(fit.mixture.weight(sharp), 0.6, 0.04);
  EXPECT_NEAR(fit.mixture[sharp].density.covariance()(2, 2), 0.01, 1.5e-3);
  EXPECT_NEAR(fit.mixture[1 - sharp].density.covariance()(2, 2), 1.0, 0.1);
  EXPECT_TRUE(fit.mixture[sharp].density.mean().is_approx(centre, 0.0));
  EXPECT_TRUE(fit.mixture[sharp].density.covariance().isDiagonal(0.0));
  EXPECT_EQ(fit.parameters, 13U);
}

TEST(Em, KeepsCovariancesWithinTheirBounds) {
  RandomStream stream(10);
  const auto samples = draws(three_poses<Gaussian<SE3d>>(), 500, stream);
  Eigen::VectorXd unit(6);
  unit << 1, 1, 1, 0.1, 0.1, 0.1;
  for (const bool diagonal : {false, true}) {
    const EmSettings settings{.components = 2,
                              .restarts = 2,
                              .diagonal = diagonal,
                              .unit = unit,
                              .min_sd = 0.3,
                              .max_sd = 0.6};
    const auto fit = fit_mixture<Gaussian<SE3d>>(samples, {}, settings, stream);
    for (const auto& component : fit.mixture.components()) {
      const Eigen::MatrixXd scaled = unit.cwiseInverse().asDiagonal() *
                                     component.density.covariance() *
                                     unit.cwiseInverse().asDiagonal();
      const Eigen::VectorXd values = scaled.selfadjointView<Eigen::Lower>().eigenvalues();
      EXPECT_GE(values.minCoeff(), 0.09 * (1.0 - 1e-12));
      EXPECT_LE(values.maxCoeff(), 0.36 * (1.0 + 1e-12));
    }
  }
}

TEST(Em, RefusesBadInput) {
  RandomStream stream(13);
  auto samples = draws(three_poses<Gaussian<SE3d>>(), 30, stream);
  const auto message = [&](const std::vector<SE3d>& s, const std::vector<double>& w,
                           const EmSettings& settings) {
    return thrown_message([&] { fit_mixture<Gaussian<SE3d>>(s, w, settings, stream); });
  };
  EXPECT_EQ(message({}, {}, {}), "EM: there are no samples");
  EXPECT_EQ(message(samples, {1.0}, {}), "EM: 1 weights for 30 samples");
  std::vector<double> weights(30, 1.0);
  weights[4] = -1.0;
  EXPECT_EQ(message(samples, weights, {}), "EM: weight 4 is -1, expected a finite number >= 0");
  EXPECT_EQ(message(samples, {}, {.components = 5}),
            "EM: 30 samples of positive weight, expected at least 35 for so many components");
  EXPECT_EQ(message(samples, {}, {.components = 0}), "EM: components is 0, expected one or more");
  EXPECT_EQ(message(samples, {}, {.max_iterations = 0}),
            "EM: max_iterations is 0, expected one or more");
  EXPECT_EQ(message(samples, {}, {.restarts = 0}), "EM: restarts is 0, expected one or more");
  EXPECT_EQ(message(samples, {}, {.tolerance = -1.0}),
            "EM: tolerance is -1, expected zero or more");
  EXPECT_EQ(message(samples, {}, {.min_sd = 0.0}),
            "EM: min_sd is 0, expected a finite number above zero");
  EXPECT_EQ(message(samples, {}, {.unit = Eigen::VectorXd::Ones(3)}),
            "EM: size of unit is 3, expected the degrees of freedom");
  samples[7] = SE3d(SO3d(), Eigen::Vector3d(0, std::numeric_limits<double>::quiet_NaN(), 0));
  EXPECT_EQ(message(samples, {}, {}),
            "EM: sample 7 is not finite, or not of 6 degrees of freedom as the first");
}

}  // namespace
}  // namespace posemix
