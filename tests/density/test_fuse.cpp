// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "posemix/density/operations.hpp"
#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"
#include "posemix/testing/rotation_quadrature.hpp"

namespace posemix {
namespace {

using testing::check_property;
using testing::draw_gaussian;
using testing::relative_difference;

template <class G>
class FuseOn : public ::testing::Test {};
using Groups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(FuseOn, Groups);

/// Two densities at most a few deviations apart.
template <class G>
std::pair<ConcentratedGaussian<G>, ConcentratedGaussian<G>> draw_pair() {
  const G centre = testing::draw_near_identity<G>(1.0);
  const auto p = draw_gaussian<G>(0.3, 0.3);
  const auto q = draw_gaussian<G>(0.3, 0.2);
  return {{p.mean() * centre, p.covariance()}, {q.mean() * centre, q.covariance()}};
}

TEST(FuseOnVectors, IsTheClosedForm) {
  check_property([] {
    const auto p = draw_gaussian<Rnd<3>>(2.0, 0.5);
    const auto q = draw_gaussian<Rnd<3>>(2.0, 0.3);
    const auto fused = fuse(p, q);
    // N(x; a, A) N(x; b, B) = N(a; b, A + B) N(x; c, C), C^-1 = A^-1 + B^-1, c = C (A^-1 a + B^-1
    // b).
    const Eigen::Matrix3d info_p = p.covariance().inverse();
    const Eigen::Matrix3d info_q = q.covariance().inverse();
    const Eigen::Matrix3d covariance = (info_p + info_q).inverse();
    const Eigen::Vector3d mean =
        covariance * (info_p * p.mean().value() + info_q * q.mean().value());
    const Eigen::Matrix3d sum = p.covariance() + q.covariance();
    const Eigen::Vector3d d = p.mean().value() - q.mean().value();
    const double overlap = -0.5 * (d.dot(sum.inverse() * d) + std::log(sum.determinant()) +
                                   3.0 * std::log(2.0 * std::numbers::pi));
    RC_ASSERT(fused.converged);
    RC_ASSERT((fused.density.mean().value() - mean).norm() < 1e-10);
    RC_ASSERT(relative_difference(fused.density.covariance(), covariance) < 1e-10);
    RC_ASSERT(std::abs(fused.log_overlap - overlap) < 1e-9 * (1.0 + std::abs(overlap)));
  });
}

/// Deviations of 1e-3 to 1e3 along axes of their own, a million from the origin; the reference is
/// the information form in long double, which loses twelve of its nineteen digits.
TEST(FuseOnVectors, HoldsForDeviationsOfManySizes) {
  using Matrix = Eigen::Matrix<long double, 3, 3>;
  const auto covariance = [](const Eigen::Vector3d& axis, const Eigen::Vector3d& sd) {
    const Eigen::Matrix3d turn = SO3d::exp(axis).matrix();
    Eigen::Matrix3d result = turn * sd.cwiseAbs2().asDiagonal() * turn.transpose();
    symmetrize(result);
    return result;
  };
  const Rnd<3> at(Eigen::Vector3d(1e6, -1e6, 1e6));
  const Rnd<3> beside(Eigen::Vector3d(1e6, -1e6 + 0.5, 1e6));
  const ConcentratedGaussian<Rnd<3>> p(at, covariance({0.0, 0.0, 0.0}, {1e3, 1.0, 1e-3}));
  const ConcentratedGaussian<Rnd<3>> q(beside, covariance({0.0, 0.0, 1.0}, {1e-3, 1e3, 1.0}));
  const auto fused = fuse(p, q);
  const Matrix info_p = p.covariance().cast<long double>().inverse();
  const Matrix info_q = q.covariance().cast<long double>().inverse();
  const Matrix expected = (info_p + info_q).inverse();
  EXPECT_EQ(Eigen::LLT<Eigen::Matrix3d>(fused.density.covariance()).info(), Eigen::Success);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto variance = static_cast<double>(expected(i, i));
    EXPECT_NEAR(fused.density.covariance()(i, i), variance, 1e-6 * variance);
  }
  const Eigen::Vector3d swapped = fuse(q, p).density.mean().value() - fused.density.mean().value();
  EXPECT_LT(swapped.norm(), 1e-8);
}

/// A plane turned by `angle`: the deviations are 1 m along it and `thin` [m^2 of variance] across.
ConcentratedGaussian<Rnd<2>> thin_gaussian(const Eigen::Vector2d& mean, double angle, double wide,
                                           double thin) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  Eigen::Matrix2d covariance = turn * Eigen::Vector2d(wide, thin).asDiagonal() * turn.transpose();
  symmetrize(covariance);
  return {Rnd<2>(mean), covariance};
}

TEST(FuseOnVectors, OfOneMeanHasThatMeanHoweverFarAndThin) {
  for (const double thin : {1e-4, 1e-8, 1e-10, 1e-12}) {
    for (const double far : {1.0, 1e3, 1e6}) {
      const Eigen::Vector2d mean(far, 0.3 * far);
      const auto p = thin_gaussian(mean, 0.5, 1.0, thin);
      const auto q = thin_gaussian(mean, 0.5, 2.0, 3.0 * thin);
      EXPECT_EQ(fuse(p, q).density.mean().value(), mean) << thin << ' ' << far;
    }
  }
}

TEST(FuseOnVectors, StaysPositiveDefiniteWhereBothAreThinInOneDirection) {
  const auto p = thin_gaussian({0.0, 0.0}, 0.314, 1.0, 1e-12);
  const auto q = thin_gaussian({0.0, 0.0}, 0.31401, 1.0, 1e-12);
  const Eigen::Matrix2d covariance = fuse(p, q).density.covariance();
  EXPECT_EQ(Eigen::LLT<Eigen::Matrix2d>(covariance).info(), Eigen::Success) << covariance;
  using Matrix = Eigen::Matrix<long double, 2, 2>;
  const Matrix info_p = p.covariance().cast<long double>().inverse();
  const Matrix info_q = q.covariance().cast<long double>().inverse();
  const Matrix expected = (info_p + info_q).inverse();
  EXPECT_NEAR(covariance.trace(), static_cast<double>(expected.trace()),
              1e-3 * static_cast<double>(expected.trace()));
}

TYPED_TEST(FuseOn, IsSymmetricInItsArguments) {
  check_property([] {
    const auto [p, q] = draw_pair<TypeParam>();
    const auto forth = fuse(p, q);
    const auto back = fuse(q, p);
    RC_ASSERT(forth.converged && back.converged);
    RC_ASSERT(forth.density.mean().is_approx(back.density.mean(), 1e-9));
    RC_ASSERT(relative_difference(forth.density.covariance(), back.density.covariance()) < 1e-8);
    RC_ASSERT(std::abs(forth.log_overlap - back.log_overlap) <
              1e-8 * (1.0 + std::abs(forth.log_overlap)));
  });
}

TYPED_TEST(FuseOn, WithItselfHalvesTheCovariance) {
  check_property([] {
    const auto p = draw_gaussian<TypeParam>(1.0, 0.2);
    const auto fused = fuse(p, p);
    // integral of N(x; m, P)^2 dx = N(0; 0, 2 P).
    const Eigen::MatrixXd twice = 2.0 * p.covariance();
    const double overlap = -0.5 * (std::log(twice.determinant()) +
                                   static_cast<double>(p.dof()) * std::log(2.0 * std::numbers::pi));
    RC_ASSERT(fused.density.mean().is_approx(p.mean(), 1e-12));
    RC_ASSERT(relative_difference(fused.density.covariance(), 0.5 * p.covariance()) < 1e-10);
    RC_ASSERT(std::abs(fused.log_overlap - overlap) < 1e-9 * (1.0 + std::abs(overlap)));
  });
}

/// -log p without normaliser and volume factor.
template <class G>
double half_squared_distance(const ConcentratedGaussian<G>& density, const G& x) {
  const Eigen::VectorXd xi = (x * density.mean().inverse()).log();
  const Eigen::MatrixXd covariance = density.covariance();
  return 0.5 * xi.dot(covariance.llt().solve(xi));
}

TYPED_TEST(FuseOn, TheMeanIsTheModeOfTheProduct) {
  check_property([] {
    using G = TypeParam;
    using Tangent = typename G::Tangent;
    const auto [p, q] = draw_pair<G>();
    const auto fused = fuse(p, q);
    RC_ASSERT(fused.converged);
    const Eigen::MatrixXd root = Eigen::MatrixXd(fused.density.covariance()).llt().matrixL();
    for (Eigen::Index i = 0; i < p.dof(); ++i) {
      // Along one deviation of the product the second derivative is about one.
      const auto cost = [&, &p = p, &q = q](double s) {
        const G x = G::exp(Tangent(s * root.col(i))) * fused.density.mean();
        return half_squared_distance(p, x) + half_squared_distance(q, x);
      };
      const double h = 1e-3;
      const double slope = (8.0 * (cost(h) - cost(-h)) - (cost(2 * h) - cost(-2 * h))) / (12.0 * h);
      RC_ASSERT(std::abs(slope) < 1e-8);
    }
  });
}

/// Relative error of the Laplace overlap on SO(3), deviations and distance proportional to `scale`.
double overlap_error(double scale) {
  Eigen::Matrix3d a;
  a << 1.0, 0.3, -0.1, 0.3, 0.6, 0.2, -0.1, 0.2, 0.8;
  Eigen::Matrix3d b;
  b << 0.5, -0.1, 0.2, -0.1, 1.2, 0.1, 0.2, 0.1, 0.7;
  const SO3d mean = SO3d::exp({0.3, -1.0, 0.7});
  const SO3d other = SO3d::exp(scale * Eigen::Vector3d(0.9, -0.4, 0.7)) * mean;
  const ConcentratedGaussian<SO3d> p(mean, scale * scale * a);
  const ConcentratedGaussian<SO3d> q(other, scale * scale * b);
  const auto fused = fuse(p, q);
  const ConcentratedGaussian<SO3d>::Evaluator log_p(p);
  const ConcentratedGaussian<SO3d>::Evaluator log_q(q);
  const testing::BallRule rule{
      .radius = std::min(std::numbers::pi, 8.0 * scale), .radial_panels = 3, .azimuths = 100};
  const double exact = rule.integrate(fused.density.mean(), [&](const SO3d& x) {
    return std::exp(log_p.log_density(x) + log_q.log_density(x));
  });
  return std::exp(fused.log_overlap) / exact - 1.0;
}

TEST(Fuse, OverlapOnRotationsAgreesWithQuadrature) {
  const double error = overlap_error(0.3);
  EXPECT_LT(std::abs(error), 0.03);
  // Laplace's approximation neglects terms quadratic in the deviations.
  EXPECT_NEAR(error / overlap_error(0.15), 4.0, 0.4);
  EXPECT_LT(std::abs(overlap_error(0.01)), 4e-5);
}

/// Wide about an axis, narrow about others.
ConcentratedGaussian<SO3d> with_deviations(const SO3d& mean, const Eigen::Vector3d& degrees) {
  const Eigen::Vector3d deviations = degrees * (std::numbers::pi / 180.0);
  return {mean, deviations.cwiseAbs2().asDiagonal()};
}

// Oracle: 400,000 rotations drawn uniformly (SciPy); the logs of the integral are those of p q.
TEST(Fuse, FindsTheHighestOfSeveralModes) {
  struct Case {
    Eigen::Vector3d p, q, turn_deg;
    double log_integral;
  };
  const std::vector<Case> cases{{{10, 10, 60}, {60, 10, 40}, {0, -90.001, 0}, -11.60},
                                {{40, 60, 10}, {10, 60, 10}, {0, 0, -120}, -13.7},
                                {{60, 40, 10}, {60, 60, 10}, {0, 0, -180}, -10.5}};
  for (const Case& one : cases) {
    const SO3d turn = SO3d::exp(one.turn_deg * (std::numbers::pi / 180.0));
    const auto p = with_deviations(SO3d(), one.p);
    const auto q = with_deviations(turn, one.q);
    const auto fused = fuse(p, q);
    EXPECT_TRUE(fused.converged);
    // Laplace's approximation of densities as wide as these.
    EXPECT_NEAR(fused.log_overlap, one.log_integral, 1.2) << one.turn_deg.transpose();
    EXPECT_NEAR(fuse(q, p).log_overlap, fused.log_overlap, 1e-9);
  }
}

/// The largest overlap of many starts.
template <class G>
double largest_overlap(const ConcentratedGaussian<G>& p, const ConcentratedGaussian<G>& q) {
  double best = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 30; ++k) {
    const auto from = internal::fuse_from(testing::draw_near_identity<G>(2.0) * p.mean(), p, q, {});
    if (from.converged) best = std::max(best, from.log_overlap);
  }
  return best;
}

/// Means at any turn, 0.3 apart.
template <class G>
void expect_no_other_start_to_find_more() {
  check_property([] {
    const ConcentratedGaussian<G> p(G(), testing::draw_spread<G>(0.4));
    typename G::Tangent apart = testing::draw_near_identity<G>(0.3).log();
    apart.template head<3>() *=
        1e-3 * testing::draw_integer(0, 3100) / apart.template head<3>().norm();
    const ConcentratedGaussian<G> q(G::exp(apart), testing::draw_spread<G>(0.4));
    RC_PRE(apart.allFinite());
    const auto fused = fuse(p, q);
    if (fused.converged) RC_ASSERT(fused.log_overlap > largest_overlap(p, q) - 1e-6);
  });
}

TEST(Fuse, NoOtherStartFindsMore) {
  expect_no_other_start_to_find_more<SO3d>();
  expect_no_other_start_to_find_more<SE3d>();
}

TEST(Fuse, ReportsWhenItHasNotConverged) {
  const Matrix6d spread = 0.04 * Matrix6d::Identity();
  const Vector6d step = (Vector6d() << 0.8, -0.5, 0.6, 1.0, -2.0, 0.5).finished();
  const ConcentratedGaussian<SE3d> p(SE3d(), spread);
  const ConcentratedGaussian<SE3d> q(SE3d::exp(step), 0.5 * spread);
  const auto stopped = fuse(p, q, {.max_iterations = 1});
  EXPECT_FALSE(stopped.converged);
  EXPECT_EQ(stopped.iterations, 1);
  const auto finished = fuse(p, q);
  EXPECT_TRUE(finished.converged);
  EXPECT_LT(finished.iterations, 20);
}

TEST(Fuse, RejectsUnusableArguments) {
  const auto stack = [](std::size_t size) {
    const auto n = static_cast<Eigen::Index>(6 * size);
    return ConcentratedGaussian<PoseStackd>(PoseStackd(size), Eigen::MatrixXd::Identity(n, n));
  };
  EXPECT_EQ(testing::thrown_message([&] { fuse(stack(1), stack(2)); }),
            "fuse: densities of 6 and 12 degrees of freedom");
  EXPECT_EQ(testing::thrown_message([&] { fuse(stack(1), stack(1), {.max_iterations = 0}); }),
            "fuse: max_iterations must be at least 1");
}

TEST(Fuse, ConvergesFarFromTheOrigin) {
  // Map coordinates, where rounding alone exceeds the default tolerance.
  const SE3d far(SO3d::exp({0.3, 1.0, -2.0}), {4.2e6, 5.5e5, 4.7e6});
  Matrix6d covariance = 1e-4 * Matrix6d::Identity();
  covariance.bottomRightCorner<3, 3>() *= 100.0;
  const ConcentratedGaussian<SE3d> p(SE3d::exp(Vector6d::Constant(1e-3)) * far, covariance);
  const ConcentratedGaussian<SE3d> q(far, covariance);
  EXPECT_TRUE(fuse(p, q).converged);
}

}  // namespace
}  // namespace posemix
