// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "em_draws.hpp"
#include "posemix/mixture/em.hpp"

namespace posemix {
namespace {

using testing::draws;
using testing::log_likelihood;
using testing::Projected;
using testing::random_covariance;
using testing::random_element;
using testing::random_projected;
using testing::worst_fall;

template <class G>
class ProjectedEmOn : public ::testing::Test {};
using Groups = ::testing::Types<SO3d, SE3d>;
TYPED_TEST_SUITE(ProjectedEmOn, Groups);

/// Samples with deviations of three to twenty degrees (u is half the angle) and once 57 degrees,
/// with weights, bounds, and all kinds of settings.
TYPED_TEST(ProjectedEmOn, NeverLowersTheLogLikelihood) {
  using D = Projected<TypeParam>;
  double fall = 0.0;
  std::size_t iterations = 0;
  for (std::uint64_t seed = 0; seed < 48; ++seed) {
    RandomStream stream(17, seed);
    const double reach = seed % 3 == 0 ? 2.0 : 0.6;
    const double spread = seed % 8 == 0 ? 1.0 : (seed % 2 == 0 ? 0.35 : 0.1);
    const auto samples = draws(random_projected<TypeParam>(3, reach, spread, stream), 150, stream);
    const EmSettings settings{.components = 1 + seed % 4,
                              .max_iterations = 60,
                              .tolerance = 0.0,
                              .restarts = 2,
                              .fixed_means = seed % 8 == 7,
                              .diagonal = seed % 5 == 4,
                              .min_sd = 1e-3,
                              .max_sd = seed % 6 == 5 ? 0.5 : 1e3};
    const auto fit = fit_mixture<D>(samples, {}, settings, stream);
    fall = std::max(fall, worst_fall(fit.history));
    iterations += fit.history.size();
    EXPECT_NEAR(fit.log_likelihood, log_likelihood(fit.mixture, samples),
                1e-9 * std::abs(fit.log_likelihood) + 1e-9);
    EXPECT_EQ(fit.log_likelihood, fit.history.back());
  }
  EXPECT_LE(fall, 1e-9);
  EXPECT_GT(iterations, 1000U);
}

template <class G>
double perturbed(const Mixture<Projected<G>>& mixture, std::size_t k,
                 const typename G::Tangent& move, const typename G::TangentMatrix& change,
                 const std::vector<G>& samples) {
  std::vector<Component<Projected<G>>> components = mixture.components();
  Projected<G>& density = components[k].density;
  typename G::Tangent mean = density.tangent_mean() + move;
  const SO3d tangent_point = gnomonic::project(density.tangent_point(), move.template head<3>());
  mean.template head<3>().setZero();
  density =
      Projected<G>(tangent_point, mean, typename G::TangentMatrix(density.covariance() + change));
  return log_likelihood(Mixture<Projected<G>>(std::move(components)), samples);
}

/// At the end the slope of the likelihood is zero in every tangent point, translation and
/// covariance: the M-step is that of maximum likelihood, C included.
TYPED_TEST(ProjectedEmOn, EndsWhereTheLikelihoodIsStationary) {
  using G = TypeParam;
  RandomStream stream(11);
  const Mixture<Projected<G>> truth = random_projected<G>(2, 0.7, 0.4, stream);
  const auto samples = draws(truth, 400, stream);
  const EmSettings settings{.components = 2, .max_iterations = 4000, .tolerance = 0.0};
  const auto fit = fit_mixture<Projected<G>>(samples, {}, settings, stream, std::optional(truth));
  ASSERT_EQ(fit.status, EmStatus::converged);
  const typename G::TangentMatrix none = G::TangentMatrix::Zero();
  const typename G::Tangent still = G::Tangent::Zero();
  constexpr double kStep = 1e-5;
  for (std::size_t k = 0; k < 2; ++k) {
    for (Eigen::Index i = 0; i < G::Dof; ++i) {
      const typename G::Tangent move = kStep * G::Tangent::Unit(i);
      const double slope = (perturbed<G>(fit.mixture, k, move, none, samples) -
                            perturbed<G>(fit.mixture, k, -move, none, samples)) /
                           (2.0 * kStep);
      EXPECT_NEAR(slope, 0.0, 2e-2) << "mean " << k << " along " << i;
      for (Eigen::Index j = 0; j <= i; ++j) {
        typename G::TangentMatrix change = none;
        change(i, j) = change(j, i) = kStep * fit.mixture[k].density.covariance()(i, i);
        const double growth = (perturbed<G>(fit.mixture, k, still, change, samples) -
                               perturbed<G>(fit.mixture, k, still, -change, samples)) /
                              (2.0 * kStep);
        EXPECT_NEAR(growth, 0.0, 2e-2) << "covariance " << k << " at " << i << ", " << j;
      }
    }
  }
}

/// Compares the loops with vector instructions to the class.
TYPED_TEST(ProjectedEmOn, KernelsAgreeWithTheClass) {
  using G = TypeParam;
  RandomStream stream(14);
  std::vector<G> samples;
  for (int i = 0; i < 83; ++i) samples.push_back(random_element<G>(1.5, stream));
  typename G::Tangent mean = G::Tangent::Constant(0.2);
  const Projected<G> density(SO3d::exp({0.2, 0.1, -0.7}), mean, random_covariance<G>(0.5, stream));
  const EmSettings settings;
  typename EmModel<Projected<G>>::Worker worker(density, settings);
  EmRow log;
  worker.log_density(EmCoordinates{std::span<const G>(samples)}, 0, samples.size(), log);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double direct = density.log_density(samples[i]);
    EXPECT_NEAR(log[i], direct, 1e-12 * (1.0 + std::abs(direct)));
    const typename G::Tangent y = density.coordinates(samples[i]) - mean;
    for (std::size_t j = 0; j < G::Dof; ++j) {
      EXPECT_NEAR(worker.rows()[j][i], y[static_cast<Eigen::Index>(j)], 1e-13 * (1.0 + y.norm()));
    }
  }
}

}  // namespace
}  // namespace posemix
