// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em.hpp"

#include <gtest/gtest.h>

#include "em_draws.hpp"

namespace posemix {
namespace {

using testing::draws;
using testing::Gaussian;
using testing::log_likelihood;
using testing::Projected;
using testing::random_covariance;
using testing::random_element;
using testing::random_mixture_of;
using testing::tested_dof;
using testing::worst_fall;

template <class D>
class EmOn : public ::testing::Test {};
using Densities =
    ::testing::Types<Gaussian<SO3d>, Gaussian<SE3d>, Gaussian<PoseStackd>, Gaussian<Rnd<3>>,
                     Gaussian<Rnd<Eigen::Dynamic>>, Projected<SO3d>, Projected<SE3d>>;
TYPED_TEST_SUITE(EmOn, Densities);

/// What the fits of a kind of density are tested with.
struct Trials {
  std::uint64_t seeds;
  std::uint64_t least_iterations;  ///< of all fits together
  double wide;                     ///< spread of the samples in some of the trials
  double narrow;                   ///< in the others
  double largest_sd;               ///< bound of some of the trials
};

template <class D>
Trials trials() {
  using G = typename D::Group;
  if (!std::is_same_v<D, Gaussian<G>>) return {48, 1000, 0.35, 0.1, 0.5};
  return {G::Dof == Eigen::Dynamic ? 8U : 24U, 150, 0.9, 0.3, 0.7};
}

/// All kinds of settings, and once a spread of 57 degrees or more.
TYPED_TEST(EmOn, NeverLowersTheLogLikelihood) {
  const Trials trial = trials<TypeParam>();
  double fall = 0.0;
  std::size_t iterations = 0;
  for (std::uint64_t seed = 0; seed < trial.seeds; ++seed) {
    RandomStream stream(7, seed);
    const double reach = seed % 3 == 0 ? 2.0 : 0.6;
    const double spread = seed % 8 == 0 ? 1.0 : (seed % 2 == 0 ? trial.wide : trial.narrow);
    const auto samples = draws(random_mixture_of<TypeParam>(3, reach, spread, stream), 150, stream);
    const EmSettings settings{.components = 1 + seed % 4,
                              .max_iterations = 60,
                              .tolerance = 0.0,
                              .restarts = 2,
                              .fixed_means = seed % 8 == 7,
                              .diagonal = seed % 5 == 4,
                              .min_sd = 1e-3,
                              .max_sd = seed % 6 == 5 ? trial.largest_sd : 1e3};
    const auto fit = fit_mixture<TypeParam>(samples, {}, settings, stream);
    fall = std::max(fall, worst_fall(fit.history));
    iterations += fit.history.size();
    EXPECT_NEAR(fit.log_likelihood, log_likelihood(fit.mixture, samples),
                1e-9 * std::abs(fit.log_likelihood) + 1e-9);
    EXPECT_EQ(fit.log_likelihood, fit.history.back());
  }
  EXPECT_LE(fall, 1e-9);
  EXPECT_GT(iterations, trial.least_iterations);
}

template <LieGroup G>
Gaussian<G> changed(const Gaussian<G>& density, const typename G::Tangent& move,
                    const typename G::TangentMatrix& change) {
  return {G::exp(move) * density.mean(), typename G::TangentMatrix(density.covariance() + change)};
}

template <class G>
Projected<G> changed(const Projected<G>& density, const typename G::Tangent& move,
                     const typename G::TangentMatrix& change) {
  typename G::Tangent mean = density.tangent_mean() + move;
  mean.template head<3>().setZero();
  return {gnomonic::project(density.tangent_point(), move.template head<3>()), mean,
          typename G::TangentMatrix(density.covariance() + change)};
}

/// The log-likelihood of the mixture with component k moved and its spread changed.
template <class D>
double changed_log_likelihood(const Mixture<D>& mixture, std::size_t k,
                              const typename D::Group::Tangent& move,
                              const typename D::Group::TangentMatrix& change,
                              const std::vector<typename D::Group>& samples) {
  std::vector<Component<D>> components = mixture.components();
  components[k].density = changed(components[k].density, move, change);
  return log_likelihood(Mixture<D>(std::move(components)), samples);
}

/// At the end the slope of the likelihood is zero in every mean and covariance: the M-step is that
/// of maximum likelihood, with the volume factor and the constant C. (Without the volume factor
/// slopes of up to 0.3 are left here.)
TYPED_TEST(EmOn, EndsWhereTheLikelihoodIsStationary) {
  using G = typename TypeParam::Group;
  RandomStream stream(11);
  const double spread = std::is_same_v<TypeParam, Gaussian<G>> ? 0.5 : 0.4;
  const Mixture<TypeParam> truth = random_mixture_of<TypeParam>(2, 0.7, spread, stream);
  const auto samples = draws(truth, 400, stream);
  const EmSettings settings{.components = 2, .max_iterations = 4000, .tolerance = 0.0};
  const auto fit = fit_mixture<TypeParam>(samples, {}, settings, stream, std::optional(truth));
  ASSERT_EQ(fit.status, EmStatus::converged);
  const Eigen::Index n = tested_dof<G>();
  const typename G::TangentMatrix none = G::TangentMatrix::Zero(n, n);
  const typename G::Tangent still = G::Tangent::Zero(n);
  constexpr double kStep = 1e-5;
  for (std::size_t k = 0; k < 2; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const typename G::Tangent move = kStep * G::Tangent::Unit(n, i);
      const double slope = (changed_log_likelihood(fit.mixture, k, move, none, samples) -
                            changed_log_likelihood(fit.mixture, k, -move, none, samples)) /
                           (2.0 * kStep);
      EXPECT_NEAR(slope, 0.0, 2e-2) << "mean " << k << " along " << i;
      for (Eigen::Index j = 0; j <= i; ++j) {
        typename G::TangentMatrix change = none;
        change(i, j) = change(j, i) = kStep * fit.mixture[k].density.covariance()(i, i);
        const double growth = (changed_log_likelihood(fit.mixture, k, still, change, samples) -
                               changed_log_likelihood(fit.mixture, k, still, -change, samples)) /
                              (2.0 * kStep);
        EXPECT_NEAR(growth, 0.0, 2e-2) << "covariance " << k << " at " << i << ", " << j;
      }
    }
  }
}

template <class G>
class ProjectedEmOn : public ::testing::Test {};
using EmGroups = ::testing::Types<SO3d, SE3d>;
TYPED_TEST_SUITE(ProjectedEmOn, EmGroups);

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
