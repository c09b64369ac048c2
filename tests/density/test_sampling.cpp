// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <gtest/gtest.h>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/testing/statistics.hpp"

namespace posemix {
namespace {

constexpr int kManyDraws = 100'000;

template <class G>
class Sampling : public ::testing::Test {
 protected:
  static constexpr Eigen::Index kDof = G::Dof == Eigen::Dynamic ? 12 : G::Dof;

  /// A correlated covariance with standard deviations between 0.05 and 0.35 (rad, m).
  static ConcentratedGaussian<G> density() {
    typename G::TangentMatrix root = G::TangentMatrix::Identity(kDof, kDof);
    for (Eigen::Index i = 1; i < kDof; ++i) root(i, i - 1) = -0.6;
    for (Eigen::Index i = 0; i < kDof; ++i) {
      root.row(i) *= 0.05 + 0.25 * static_cast<double>(i) / static_cast<double>(kDof);
    }
    typename G::Tangent log_mean(kDof);
    for (Eigen::Index i = 0; i < kDof; ++i)
      log_mean[i] = 0.4 * std::cos(1.0 + 2.0 * static_cast<double>(i));
    return ConcentratedGaussian<G>(G::exp(log_mean), root * root.transpose());
  }

  /// Calls `visit` with the left perturbation of every draw.
  template <class Visit>
  static void for_each_draw(const ConcentratedGaussian<G>& density, std::uint64_t seed,
                            Visit&& visit) {
    RandomStream stream(seed);
    const G inverse_mean = density.mean().inverse();
    for (int i = 0; i < kManyDraws; ++i) visit((density.sample(stream) * inverse_mean).log());
  }
};

using Groups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(Sampling, Groups);

TYPED_TEST(Sampling, MomentsOfTheLeftPerturbation) {
  const auto density = this->density();
  testing::SampleMoments moments(density.dof());
  this->for_each_draw(density, 1, [&](const auto& xi) { moments.add(xi); });
  // The worst of at most 156 scores; 5 standard errors are passed with probability 1 - 1e-4.
  EXPECT_LT(moments.worst_score(Eigen::VectorXd::Zero(density.dof()), density.covariance()), 5.0);
}

TYPED_TEST(Sampling, SquaredMahalanobisDistancesAreChiSquare) {
  const auto density = this->density();
  const Eigen::LLT<Eigen::MatrixXd> factor(density.covariance());
  double sum = 0.0;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(density.dof());
  int within_median = 0;
  const double n = static_cast<double>(density.dof());
  const double median = boost::math::median(boost::math::chi_squared(n));
  this->for_each_draw(density, 2, [&](const auto& xi) {
    const Eigen::VectorXd white = factor.matrixL().solve(Eigen::VectorXd(xi));
    sum += white.squaredNorm();
    mean += white;
    if (white.squaredNorm() < median) ++within_median;
  });
  const auto [low, high] = testing::chi_square_band(n * kManyDraws);
  EXPECT_GT(sum, low);
  EXPECT_LT(sum, high);
  EXPECT_LT(mean.squaredNorm() / kManyDraws, testing::chi_square_band(n).second);
  EXPECT_NEAR(within_median, 0.5 * kManyDraws, 5.0 * std::sqrt(0.25 * kManyDraws));
}

TYPED_TEST(Sampling, TheStreamDecidesTheDraws) {
  const auto density = this->density();
  RandomStream one(7);
  RandomStream same(7);
  RandomStream other(7, 1);
  const TypeParam draw = density.sample(one);
  EXPECT_TRUE(draw.is_approx(density.sample(same), 1e-12));
  EXPECT_FALSE(draw.is_approx(density.sample(other), 1e-6));
  EXPECT_FALSE(draw.is_approx(density.sample(one), 1e-6));
}

}  // namespace
}  // namespace posemix
