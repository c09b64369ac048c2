// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/density/operations.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "posemix/density/projected_operations.hpp"
#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"
#include "posemix/testing/numeric_jacobian.hpp"
#include "posemix/testing/statistics.hpp"

namespace posemix {
namespace {

using testing::check_property;
using testing::draw_gaussian;
using testing::draw_near_identity;
using testing::numeric_jacobian;
using testing::relative_difference;

template <class G>
class OperationsOn : public ::testing::Test {};
using Groups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(OperationsOn, Groups);

Eigen::MatrixXd congruence(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& p) {
  return jacobian * p * jacobian.transpose();
}

TYPED_TEST(OperationsOn, RecenterIsTheLinearisedChangeOfTangentSpace) {
  check_property([] {
    using G = TypeParam;
    using Tangent = typename G::Tangent;
    const auto density = draw_gaussian<G>(1.0, 0.3);
    const G anchor = draw_near_identity<G>(0.6);
    const auto moved = recenter(density, anchor);
    // xi -> Log(Exp(xi) X0 A^-1), differentiated in the vector space.
    const Eigen::Index n = density.dof();
    const G offset = density.mean() * anchor.inverse();
    Eigen::MatrixXd jacobian(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      jacobian.col(i) = testing::derivative_at_zero<double>([&](double s) -> Eigen::VectorXd {
        return (G::exp(Tangent(s * Tangent::Unit(n, i))) * offset).log();
      });
    }
    RC_ASSERT(moved.anchor.is_approx(anchor, 1e-15));
    RC_ASSERT((moved.mean - offset.log()).norm() < 1e-12);
    RC_ASSERT(relative_difference(moved.covariance, congruence(jacobian, density.covariance())) <
              1e-8);
  });
}

TYPED_TEST(OperationsOn, BackProjectionUndoesRecentering) {
  check_property([] {
    using G = TypeParam;
    const auto density = draw_gaussian<G>(1.0, 0.3);
    const auto back = back_project(recenter(density, draw_near_identity<G>(0.6)));
    RC_ASSERT(back.mean().is_approx(density.mean(), 1e-12));
    RC_ASSERT(relative_difference(back.covariance(), density.covariance()) < 1e-11);
  });
}

TYPED_TEST(OperationsOn, ComposeIsLinearisedInBothFactors) {
  check_property([] {
    using G = TypeParam;
    using Tangent = typename G::Tangent;
    const auto x = draw_gaussian<G>(1.0, 0.3);
    const auto y = draw_gaussian<G>(1.0, 0.2);
    const auto by_x = [&](const Tangent& xi) { return G::exp(xi) * x.mean() * y.mean(); };
    const auto by_y = [&](const Tangent& xi) { return x.mean() * (G::exp(xi) * y.mean()); };
    const auto product = compose(x, y);
    const Eigen::MatrixXd expected =
        congruence(numeric_jacobian<G>(x.dof(), by_x), x.covariance()) +
        congruence(numeric_jacobian<G>(x.dof(), by_y), y.covariance());
    RC_ASSERT(product.mean().is_approx(x.mean() * y.mean(), 1e-14));
    RC_ASSERT(relative_difference(product.covariance(), expected) < 1e-9);
  });
}

TYPED_TEST(OperationsOn, InverseIsLinearised) {
  check_property([] {
    using G = TypeParam;
    const auto x = draw_gaussian<G>(1.0, 0.3);
    const auto by_x = [&](const typename G::Tangent& xi) {
      return (G::exp(xi) * x.mean()).inverse();
    };
    const Eigen::MatrixXd jacobian = numeric_jacobian<G>(x.dof(), by_x);
    const auto inverted = inverse(x);
    RC_ASSERT(inverted.mean().is_approx(x.mean().inverse(), 1e-14));
    RC_ASSERT(relative_difference(inverted.covariance(), congruence(jacobian, x.covariance())) <
              1e-9);
  });
}

TYPED_TEST(OperationsOn, BetweenIsLinearisedInBothFactors) {
  check_property([] {
    using G = TypeParam;
    using Tangent = typename G::Tangent;
    const auto x = draw_gaussian<G>(1.0, 0.3);
    const auto y = draw_gaussian<G>(1.0, 0.2);
    const auto by_x = [&](const Tangent& xi) {
      return (G::exp(xi) * x.mean()).inverse() * y.mean();
    };
    const auto by_y = [&](const Tangent& xi) { return x.mean().inverse() * G::exp(xi) * y.mean(); };
    const auto relative = between(x, y);
    const Eigen::MatrixXd expected =
        congruence(numeric_jacobian<G>(x.dof(), by_x), x.covariance()) +
        congruence(numeric_jacobian<G>(x.dof(), by_y), y.covariance());
    RC_ASSERT(relative.mean().is_approx(x.mean().inverse() * y.mean(), 1e-14));
    RC_ASSERT(relative_difference(relative.covariance(), expected) < 1e-9);
  });
}

/// A correlated pose density with standard deviations of about `spread` (rad, m).
ConcentratedGaussian<SE3d> pose_density(const Vector6d& log_mean, double spread) {
  Matrix6d root = Matrix6d::Identity();
  for (Eigen::Index i = 1; i < 6; ++i) root(i, i - 1) = 0.5;
  return {SE3d::exp(log_mean), spread * spread * root * root.transpose()};
}

const Vector6d kX = (Vector6d() << 0.8, -0.5, 1.0, 0.4, 1.5, -0.7).finished();
const Vector6d kY = (Vector6d() << -0.3, 1.2, 0.4, -1.0, 0.2, 0.9).finished();

// Monte Carlo over 40,000 draws with deviations of 0.02: neglected terms are of relative size
// 0.02^2, far below one standard error (0.007 of a variance).
constexpr int kDraws = 40'000;
constexpr double kSpread = 0.02;

/// Worst score of the perturbations of `draw(stream)` around the mean of `expected`.
template <class Draw>
double worst_score(const ConcentratedGaussian<SE3d>& expected, const Draw& draw) {
  RandomStream stream(11);
  testing::SampleMoments moments(6);
  const SE3d inverse_mean = expected.mean().inverse();
  for (int i = 0; i < kDraws; ++i) moments.add((draw(stream) * inverse_mean).log());
  return moments.worst_score(Vector6d::Zero(), expected.covariance(), 5.0 * kSpread * kSpread);
}

TEST(Operations, ComposeAgreesWithMonteCarlo) {
  const auto x = pose_density(kX, kSpread);
  const auto y = pose_density(kY, kSpread);
  const auto draw = [&](RandomStream& stream) { return x.sample(stream) * y.sample(stream); };
  EXPECT_LT(worst_score(compose(x, y), draw), 4.5);
  EXPECT_GT(worst_score(compose(y, x), draw), 20.0);  // the order matters, and the test detects it
}

TEST(Operations, InverseAgreesWithMonteCarlo) {
  const auto x = pose_density(kX, kSpread);
  const auto draw = [&](RandomStream& stream) { return x.sample(stream).inverse(); };
  EXPECT_LT(worst_score(inverse(x), draw), 4.5);
}

TEST(Operations, BetweenAgreesWithMonteCarlo) {
  const auto x = pose_density(kX, kSpread);
  const auto y = pose_density(kY, kSpread);
  const auto draw = [&](RandomStream& stream) {
    return x.sample(stream).inverse() * y.sample(stream);
  };
  EXPECT_LT(worst_score(between(x, y), draw), 4.5);
}

// The square of a lever of 1e299 m is no number.
TEST(Operations, OfPosesSoFarAwayThatVariancesOverflowAreRefused) {
  const SE3d far_away(SO3d(), {1e299, 0.0, 0.0});
  const ConcentratedGaussian<SE3d> at_origin(SE3d(), 1e-7 * Matrix6d::Identity());
  const ConcentratedGaussian<SE3d> away(far_away, 1e-7 * Matrix6d::Identity());
  const std::string expected = ": the result overflows; expected poses nearer to the origin";
  EXPECT_EQ(testing::thrown_message([&] { compose(away, at_origin); }), "composition" + expected);
  EXPECT_EQ(testing::thrown_message([&] { inverse(away); }), "inverse" + expected);
  EXPECT_EQ(testing::thrown_message([&] { between(away, at_origin); }), "inverse" + expected);
  EXPECT_EQ(compose(at_origin, away).covariance()(5, 5), 2e-7);
  // A turn by 45 deg makes one coordinate of two, and no lever.
  const SE3d eighth(SO3d::exp({0.0, 0.0, 0.25 * std::numbers::pi}), Eigen::Vector3d::Zero());
  const ConcentratedGaussian<SE3d> turn(eighth, 1e-7 * Matrix6d::Identity());
  const ConcentratedGaussian<SE3d> farthest(SE3d(SO3d(), {1.7e308, 1.7e308, 0.0}),
                                            1e-7 * Matrix6d::Identity());
  EXPECT_EQ(testing::thrown_message([&] { compose(turn, farthest); }), "composition" + expected);
}

TEST(Operations, OfProjectedGaussiansAreRefusedThereToo) {
  const SE3d far_away(SO3d(), {1e299, 0.0, 0.0});
  const ProjectedGaussian<SE3d> at_origin(SE3d(), 1e-7 * Matrix6d::Identity());
  const ProjectedGaussian<SE3d> away(far_away, 1e-7 * Matrix6d::Identity());
  for (const CompositionRule rule : {CompositionRule::jacobian, CompositionRule::cubature}) {
    EXPECT_THROW(compose(at_origin, away, rule), InvalidInput);
    EXPECT_THROW(inverse(away, rule), InvalidInput);
  }
}

/// Errors of `recenter` against the exact moments of Log(X A^-1), the covariance relative. Exact
/// and linear prediction see the same draws and their mirror images, so little noise is left.
std::pair<double, double> recentering_errors(double spread) {
  const auto density = pose_density(kX, spread);
  const SE3d anchor = SE3d::exp(0.6 * kX + 0.3 * kY);
  const auto predicted = recenter(density, anchor);
  const SE3d offset = density.mean() * anchor.inverse();
  const Matrix6d root = density.covariance().llt().matrixL();
  const Matrix6d jacobian = SE3d::left_jacobian_inverse(predicted.mean);
  Vector6d first = Vector6d::Zero();
  Matrix6d second = Matrix6d::Zero();
  RandomStream stream(12);
  Eigen::VectorXd white(6);
  for (int i = 0; i < kDraws; ++i) {
    stream.fill_normal(white);
    for (const double sign : {-1.0, 1.0}) {
      const Vector6d xi = sign * root * white;
      const Vector6d linear = jacobian * xi;
      const Vector6d exact = (SE3d::exp(xi) * offset).log() - predicted.mean;
      first += exact - linear;
      second += exact * exact.transpose() - linear * linear.transpose();
    }
  }
  return {(first / (2.0 * kDraws)).norm(),
          (second / (2.0 * kDraws)).norm() / predicted.covariance.norm()};
}

TEST(Operations, RecenterIsFirstOrderInTheSpread) {
  const auto [mean_error, covariance_error] = recentering_errors(0.1);
  const auto [halved_mean_error, halved_covariance_error] = recentering_errors(0.05);
  EXPECT_LT(mean_error, 0.05);
  EXPECT_LT(covariance_error, 0.05);
  // The neglected terms are quadratic in the spread.
  EXPECT_NEAR(mean_error / halved_mean_error, 4.0, 0.3);
  EXPECT_NEAR(covariance_error / halved_covariance_error, 4.0, 0.5);
}

}  // namespace
}  // namespace posemix
