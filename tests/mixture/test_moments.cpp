// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/moments.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"
#include "posemix/testing/rotation_quadrature.hpp"
#include "posemix/testing/statistics.hpp"

namespace posemix {
namespace {

using testing::check_property;
using testing::Components;
using testing::draw_components;
using testing::relative_difference;
using testing::thrown_message;

template <int N>
void expect_the_law_of_total_variance() {
  const Mixture mixture(draw_components<Rnd<N>>(4, 2.0, 0.7));
  Eigen::Matrix<double, N, 1> mean = Eigen::Matrix<double, N, 1>::Zero();
  for (std::size_t i = 0; i < 4; ++i) mean += mixture.weight(i) * mixture[i].density.mean().value();
  Eigen::Matrix<double, N, N> covariance = Eigen::Matrix<double, N, N>::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Matrix<double, N, 1> d = mixture[i].density.mean().value() - mean;
    covariance += mixture.weight(i) * (mixture[i].density.covariance() + d * d.transpose());
  }
  const auto result = moments(mixture);
  RC_ASSERT(result.converged);
  RC_ASSERT(result.iterations <= 2);
  RC_ASSERT((result.density.mean().value() - mean).norm() < 1e-12);
  RC_ASSERT(relative_difference(result.density.covariance(), covariance) < 1e-12);
}

TEST(MomentsOfVectors, ObeyTheLawOfTotalVariance) {
  check_property([] {
    expect_the_law_of_total_variance<1>();
    expect_the_law_of_total_variance<2>();
    expect_the_law_of_total_variance<3>();
  });
}

template <class G>
class MomentsOn : public ::testing::Test {};
using MomentGroups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(MomentsOn, MomentGroups);

TYPED_TEST(MomentsOn, OfOneComponentAreItsOwn) {
  check_property([] {
    const Mixture mixture(draw_components<TypeParam>(1, 0.5, 0.2));
    const auto result = moments(mixture);
    RC_ASSERT(result.converged);
    RC_ASSERT(result.iterations == 0);
    RC_ASSERT(result.density.mean().is_approx(mixture[0].density.mean(), 1e-14));
    RC_ASSERT(relative_difference(result.density.covariance(), mixture[0].density.covariance()) <
              1e-12);
  });
}

TYPED_TEST(MomentsOn, CommuteWithRightTranslation) {
  check_property([] {
    using G = TypeParam;
    auto components = draw_components<G>(3, 0.4, 0.2);
    const auto before = moments(Mixture(components));
    const G shift = testing::draw_near_identity<G>(1.0);
    for (auto& c : components) {
      c.density = ConcentratedGaussian<G>(c.density.mean() * shift, c.density.covariance());
    }
    const auto after = moments(Mixture(components));
    RC_ASSERT(after.density.mean().is_approx(before.density.mean() * shift, 1e-9));
    RC_ASSERT(relative_difference(after.density.covariance(), before.density.covariance()) < 1e-8);
  });
}

TYPED_TEST(MomentsOn, CommuteWithLeftTranslationToFourthOrder) {
  check_property([] {
    using G = TypeParam;
    auto components = draw_components<G>(3, 0.2, 0.05);
    const auto before = moments(Mixture(components));
    const G shift = testing::draw_near_identity<G>(1.0);
    for (auto& c : components) {
      const typename G::TangentMatrix p = shift.adjoint_congruence(c.density.covariance());
      c.density = ConcentratedGaussian<G>(shift * c.density.mean(), p);
    }
    const auto after = moments(Mixture(components));
    const typename G::TangentMatrix covariance =
        shift.adjoint_congruence(before.density.covariance());
    // The cubature points do not rotate with the covariance; on R^n that does not matter.
    RC_ASSERT(after.density.mean().is_approx(shift * before.density.mean(), 2e-4));
    RC_ASSERT(relative_difference(after.density.covariance(), covariance) < 5e-3);
  });
}

/// Three rotations about 0.8 rad apart with deviations of about `spread`.
Mixture<ConcentratedGaussian<SO3d>> rotations(double spread) {
  using D = ConcentratedGaussian<SO3d>;
  Eigen::Matrix3d p;
  p << 1.0, 0.3, -0.2, 0.3, 0.5, 0.1, -0.2, 0.1, 0.8;
  p *= spread * spread;
  const SO3d centre = SO3d::exp({1.0, -0.4, 0.6});
  return Mixture<D>::from_weights(std::vector{0.5, 0.3, 0.2},
                                  {D(centre, p), D(SO3d::exp({0.8, 0.1, 0.0}) * centre, 0.5 * p),
                                   D(SO3d::exp({0.1, -0.5, 0.6}) * centre, 2.0 * p)});
}

/// Exact E[Log(X M^-1)] and E[Log(X M^-1) Log(X M^-1)^T] at M = the mean found, by quadrature.
std::pair<Eigen::Vector3d, Eigen::Matrix3d> exact_moments(
    const Mixture<ConcentratedGaussian<SO3d>>& mixture, const SO3d& mean) {
  const Mixture<ConcentratedGaussian<SO3d>>::Evaluator evaluator(mixture);
  const testing::BallRule rule{
      .radius = 2.4, .radial_panels = 2, .polar_panels = 2, .azimuths = 80};
  const SO3d inverse_mean = mean.inverse();
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  rule.for_each(mean, [&](const SO3d& x, double weight) {
    const double mass = weight * std::exp(evaluator.log_density(x));
    const Eigen::Vector3d xi = (x * inverse_mean).log();
    first += mass * xi;
    second += mass * xi * xi.transpose();
  });
  return {first, second};
}

TEST(Moments, OnRotationsAgreeWithQuadrature) {
  const auto errors = [](double spread) {
    const auto mixture = rotations(spread);
    const auto result = moments(mixture);
    EXPECT_TRUE(result.converged);
    const auto [first, second] = exact_moments(mixture, result.density.mean());
    return std::pair(first.norm(),
                     relative_difference(Eigen::Matrix3d(result.density.covariance()), second));
  };
  const auto [mean_error, covariance_error] = errors(0.2);
  const auto [halved_mean_error, halved_covariance_error] = errors(0.1);
  EXPECT_LT(mean_error, 1e-4);
  EXPECT_LT(covariance_error, 1e-3);
  // A rule of degree three neglects terms of fourth order in the spread.
  EXPECT_NEAR(std::log2(mean_error / halved_mean_error), 4.0, 0.5);
  EXPECT_NEAR(std::log2(covariance_error / halved_covariance_error), 4.0, 0.5);
}

TEST(Moments, OnPosesAgreeWithMonteCarlo) {
  using D = ConcentratedGaussian<SE3d>;
  Matrix6d root = 0.12 * Matrix6d::Identity();
  for (Eigen::Index i = 1; i < 6; ++i) root(i, i - 1) = 0.05;
  const Matrix6d p = root * root.transpose();
  const Vector6d step = (Vector6d() << 0.5, -0.3, 0.4, 0.2, 0.6, -0.3).finished();
  const SE3d centre = SE3d::exp((Vector6d() << 1.0, 0.3, -0.7, 2.0, -1.0, 0.5).finished());
  const auto mixture = Mixture<D>::from_weights(
      std::vector{0.6, 0.3, 0.1},
      {D(centre, p), D(SE3d::exp(step) * centre, 1.5 * p), D(SE3d::exp(-step) * centre, 0.5 * p)});
  const auto result = moments(mixture);
  EXPECT_TRUE(result.converged);
  testing::SampleMoments sample(6);
  const SE3d inverse_mean = result.density.mean().inverse();
  RandomStream stream(51);
  for (int i = 0; i < 100'000; ++i) sample.add((mixture.sample(stream) * inverse_mean).log());
  EXPECT_LT(sample.worst_score(Vector6d::Zero(), result.density.covariance(), 1e-3), 4.5);
}

using Stack = ConcentratedGaussian<PoseStackd>;

/// Three correlated poses, twice, the second time moved.
Mixture<Stack> correlated_stacks() {
  Eigen::MatrixXd root = 0.12 * Eigen::MatrixXd::Identity(18, 18);
  for (Eigen::Index i = 1; i < 18; ++i) root(i, i - 1) = 0.05;
  for (Eigen::Index i = 6; i < 18; ++i) root(i, i - 6) = 0.1;
  const Eigen::MatrixXd p = root * root.transpose();
  const Vector6d step = (Vector6d() << 0.5, -0.3, 0.4, 0.2, 0.6, -0.3).finished();
  std::vector<SE3d> here, there;
  for (int i = 0; i < 3; ++i) {
    here.push_back(SE3d::exp((Vector6d() << 0.3 * i, 0.3, -0.7, 0.5, -1.0, 0.5).finished()));
    there.push_back(SE3d::exp((1.0 - 0.5 * i) * step) * here.back());
  }
  return Mixture<Stack>::from_weights(
      std::vector{0.7, 0.3}, {Stack(PoseStackd(here), p), Stack(PoseStackd(there), 1.5 * p)});
}

TEST(Moments, OfStacksAgreeWithMonteCarlo) {
  const auto mixture = correlated_stacks();
  const auto result = moments(mixture);
  EXPECT_TRUE(result.converged);
  testing::SampleMoments sample(18);
  const PoseStackd inverse_mean = result.density.mean().inverse();
  RandomStream stream(52);
  for (int i = 0; i < 100'000; ++i) sample.add((mixture.sample(stream) * inverse_mean).log());
  // The tolerance is for the rule's error of fourth order.
  EXPECT_LT(sample.worst_score(Eigen::VectorXd::Zero(18), result.density.covariance(), 1e-3), 4.5);
}

TEST(Moments, OfEveryPoseOfAStackAreThoseOfThePose) {
  const auto mixture = correlated_stacks();
  const auto result = moments(mixture);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    std::vector<Component<ConcentratedGaussian<SE3d>>> poses;
    for (const auto& [log_weight, density] : mixture.components()) {
      const Matrix6d p = density.covariance().block<6, 6>(6 * i, 6 * i);
      poses.push_back({log_weight, {density.mean()[k], p}});
    }
    const auto alone = moments(Mixture(poses));
    EXPECT_TRUE(result.density.mean()[k].is_approx(alone.density.mean(), 1e-8));
    EXPECT_LT(relative_difference(Matrix6d(result.density.covariance().block<6, 6>(6 * i, 6 * i)),
                                  alone.density.covariance()),
              1e-7);
  }
}

TEST(Moments, DoNotDependOnTheNumberOfPoses) {
  // 18 degrees in every direction: with points at sqrt(6 * 20) standard deviations these would lie
  // beyond pi.
  for (const std::size_t poses : {1U, 2U, 20U}) {
    const auto n = static_cast<Eigen::Index>(6 * poses);
    const Stack density(PoseStackd(poses), 0.1 * Eigen::MatrixXd::Identity(n, n));
    const auto result = moments(Mixture<Stack>({{0.0, density}}));
    EXPECT_TRUE(result.converged);
    EXPECT_LT(relative_difference(result.density.covariance(), density.covariance()), 1e-12);
  }
}

TEST(Moments, HaveNotConvergedWhereAComponentIsTooWide) {
  const auto converged = [](const auto& mean, double degrees) {
    using G = std::decay_t<decltype(mean)>;
    using D = ConcentratedGaussian<G>;
    const double sd = degrees * std::numbers::pi / 180.0;
    const typename G::TangentMatrix one = G::TangentMatrix::Identity(mean.dof(), mean.dof());
    return moments(Mixture<D>({{0.0, D(mean, typename G::TangentMatrix(sd * sd * one))}}))
        .converged;
  };
  EXPECT_TRUE(converged(SO3d(), 103.0));
  EXPECT_FALSE(converged(SO3d(), 104.5));
  EXPECT_TRUE(converged(SE3d(), 73.0));
  EXPECT_FALSE(converged(SE3d(), 74.0));
  EXPECT_TRUE(converged(PoseStackd(3), 73.0));
  EXPECT_FALSE(converged(PoseStackd(3), 74.0));
}

TEST(Moments, ReportWhenTheyHaveNotConverged) {
  const auto stopped = moments(rotations(0.2), {.max_iterations = 1});
  EXPECT_FALSE(stopped.converged);
  EXPECT_EQ(stopped.iterations, 1);
  EXPECT_GT(stopped.residual, 1e-10);
  const auto at_heaviest = moments(rotations(0.2), {.max_iterations = 0});
  EXPECT_FALSE(at_heaviest.converged);
  EXPECT_TRUE(at_heaviest.density.mean().is_approx(rotations(0.2)[0].density.mean(), 1e-14));
}

TEST(Moments, ConvergeFarFromTheOrigin) {
  // Map coordinates, where rounding alone exceeds the default tolerance.
  const SE3d far(SO3d::exp({0.3, 1.0, -2.0}), {4.2e6, 5.5e5, 4.7e6});
  using D = ConcentratedGaussian<SE3d>;
  const D a(far, 0.01 * Matrix6d::Identity());
  const D b(SE3d(SO3d(), {1.0, 2.0, 0.5}) * far, 0.02 * Matrix6d::Identity());
  EXPECT_TRUE(moments(Mixture<D>::from_weights(std::vector{0.6, 0.4}, {a, b})).converged);
}

TEST(Moments, RejectWhatHasNone) {
  using D = ConcentratedGaussian<SO3d>;
  const Components<SO3d> none;
  EXPECT_EQ(thrown_message([&] { moments<SO3d>(std::span<const Component<D>>(none)); }),
            "moments: there is no component");
  const Components<SO3d> weightless{
      {-std::numeric_limits<double>::infinity(), D(SO3d(), Eigen::Matrix3d::Identity())}};
  EXPECT_EQ(thrown_message([&] { moments<SO3d>(std::span<const Component<D>>(weightless)); }),
            "all weights are zero");
}

}  // namespace
}  // namespace posemix
