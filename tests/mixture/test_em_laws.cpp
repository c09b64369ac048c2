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
using testing::random_mixture;
using testing::tested_dof;
using testing::worst_fall;

template <class G>
class EmOn : public ::testing::Test {};
using Groups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(EmOn, Groups);

TYPED_TEST(EmOn, NeverLowersTheLogLikelihood) {
  using D = Gaussian<TypeParam>;
  double fall = 0.0;
  std::size_t iterations = 0;
  for (std::uint64_t seed = 0; seed < (TypeParam::Dof == Eigen::Dynamic ? 8 : 24); ++seed) {
    RandomStream stream(7, seed);
    const double reach = seed % 3 == 0 ? 2.0 : 0.6;
    const double spread = seed % 2 == 0 ? 0.9 : 0.3;
    const auto samples = draws(random_mixture<TypeParam>(3, reach, spread, stream), 150, stream);
    const EmSettings settings{.components = 1 + seed % 4,
                              .max_iterations = 60,
                              .tolerance = 0.0,
                              .restarts = 2,
                              .fixed_means = seed % 8 == 7,
                              .diagonal = seed % 5 == 4,
                              .min_sd = 1e-3,
                              .max_sd = seed % 6 == 5 ? 0.7 : 1e3};
    const auto fit = fit_mixture<D>(samples, {}, settings, stream);
    fall = std::max(fall, worst_fall(fit.history));
    iterations += fit.history.size();
    EXPECT_NEAR(fit.log_likelihood, log_likelihood(fit.mixture, samples),
                1e-9 * std::abs(fit.log_likelihood) + 1e-9);
    EXPECT_EQ(fit.log_likelihood, fit.history.back());
  }
  EXPECT_LE(fall, 1e-9);
  EXPECT_GT(iterations, 150U);
}

/// The log-likelihood of the mixture with component k moved and its spread changed.
template <LieGroup G>
double perturbed_log_likelihood(const Mixture<Gaussian<G>>& mixture, std::size_t k,
                                const typename G::Tangent& move,
                                const typename G::TangentMatrix& change,
                                const std::vector<G>& samples) {
  std::vector<Component<Gaussian<G>>> components = mixture.components();
  Gaussian<G>& density = components[k].density;
  density = Gaussian<G>(G::exp(move) * density.mean(),
                        typename G::TangentMatrix(density.covariance() + change));
  return log_likelihood(Mixture<Gaussian<G>>(std::move(components)), samples);
}

/// At the end the slope of the likelihood is zero in every mean and covariance: the M-step is that
/// of maximum likelihood, volume factor included. (Without it slopes of up to 0.3 are left here.)
TYPED_TEST(EmOn, EndsWhereTheLikelihoodIsStationary) {
  using G = TypeParam;
  RandomStream stream(11);
  const Mixture<Gaussian<G>> truth = random_mixture<G>(2, 0.7, 0.5, stream);
  const auto samples = draws(truth, 400, stream);
  const EmSettings settings{.components = 2, .max_iterations = 4000, .tolerance = 0.0};
  const auto fit = fit_mixture<Gaussian<G>>(samples, {}, settings, stream, std::optional(truth));
  ASSERT_EQ(fit.status, EmStatus::converged);
  const Eigen::Index n = tested_dof<G>();
  const typename G::TangentMatrix none = G::TangentMatrix::Zero(n, n);
  constexpr double kStep = 1e-5;
  for (std::size_t k = 0; k < 2; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const typename G::Tangent move = kStep * G::Tangent::Unit(n, i);
      const double slope = (perturbed_log_likelihood<G>(fit.mixture, k, move, none, samples) -
                            perturbed_log_likelihood<G>(fit.mixture, k, -move, none, samples)) /
                           (2.0 * kStep);
      EXPECT_NEAR(slope, 0.0, 2e-2) << "mean " << k << " along " << i;
      const double scale = fit.mixture[k].density.covariance()(i, i);
      typename G::TangentMatrix change = none;
      change(i, i) = kStep * scale;
      const typename G::Tangent still = 0.0 * move;
      const double growth = (perturbed_log_likelihood<G>(fit.mixture, k, still, change, samples) -
                             perturbed_log_likelihood<G>(fit.mixture, k, still, -change, samples)) /
                            (2.0 * kStep);
      EXPECT_NEAR(growth, 0.0, 2e-2) << "variance " << k << " along " << i;
    }
  }
}

}  // namespace
}  // namespace posemix
