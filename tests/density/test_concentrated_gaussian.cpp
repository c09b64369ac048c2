// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/density/concentrated_gaussian.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/LU>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#include "posemix/density/operations.hpp"
#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::thrown_message;
using Real = boost::multiprecision::cpp_bin_float_50;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

template <class G>
class ConcentratedGaussianOn : public ::testing::Test {};
using Groups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(ConcentratedGaussianOn, Groups);

TEST(ConcentratedGaussian, RejectsCovarianceOfOtherSize) {
  const PoseStackd two_poses(2);
  const auto make = [&](Eigen::Index rows, Eigen::Index columns) {
    return thrown_message([&] {
      ConcentratedGaussian<PoseStackd>(two_poses, Eigen::MatrixXd::Identity(rows, columns));
    });
  };
  EXPECT_EQ(make(6, 6), "covariance is 6 x 6, expected 12 x 12");
  EXPECT_EQ(make(12, 6), "covariance is 12 x 6, expected 12 x 12");
  EXPECT_EQ(make(12, 12), "");
}

TEST(ConcentratedGaussian, RejectsAMeanThatIsNotFinite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto message = [](const auto& mean) {
    using G = std::decay_t<decltype(mean)>;
    const Eigen::Index n = mean.dof();
    return thrown_message([&] {
      ConcentratedGaussian<G>(mean, typename G::TangentMatrix(G::TangentMatrix::Identity(n, n)));
    });
  };
  const std::string refused = "mean holds a value that is not finite";
  EXPECT_EQ(message(SE3d(SO3d(), {kNan, 0.0, 0.0})), refused);
  EXPECT_EQ(message(SE3d(SO3d(), {0.0, 0.0, kInfinity})), refused);
  EXPECT_EQ(message(SE3d(SO3d::exp({0.0, kNan, 0.0}), Eigen::Vector3d::Zero())), refused);
  EXPECT_EQ(message(SO3d::exp({kNan, 0.0, 0.0})), refused);
  EXPECT_EQ(message(PoseStackd({SE3d(), SE3d(SO3d(), {0.0, kNan, 0.0})})), refused);
  EXPECT_EQ(message(Rnd<3>(Eigen::Vector3d(0.0, kInfinity, 0.0))), refused);
  EXPECT_EQ(message(SE3d(SO3d(), {1e9, 0.0, 0.0})), "");
}

TEST(ConcentratedGaussian, RejectsWhatIsNoCovariance) {
  const auto make = [](const Matrix6d& covariance) {
    return thrown_message([&] { ConcentratedGaussian<SE3d>(SE3d(), covariance); });
  };
  Matrix6d covariance = Matrix6d::Identity();
  covariance(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(make(covariance), "covariance holds a value that is not finite");
  covariance(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(make(covariance), "covariance holds a value that is not finite");

  covariance = Matrix6d::Identity();
  covariance(0, 5) = 1e-6;
  EXPECT_EQ(make(covariance), "covariance is not symmetric");

  covariance = Matrix6d::Identity();
  covariance(3, 3) = -1e-3;
  EXPECT_EQ(make(covariance), "covariance is not positive definite");
  EXPECT_EQ(make(Matrix6d::Zero()), "covariance is not positive definite");
  covariance = Matrix6d::Ones();
  EXPECT_EQ(make(covariance), "covariance is not positive definite");
}

TEST(ConcentratedGaussian, TakesTheSymmetricPartOfRoundingErrors) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  covariance(0, 1) = 2e-10;
  const ConcentratedGaussian<SO3d> density(SO3d(), covariance);
  EXPECT_DOUBLE_EQ(density.covariance()(0, 1), 1e-10);
  EXPECT_DOUBLE_EQ(density.covariance()(1, 0), 1e-10);
}

TEST(ConcentratedGaussian, DensityAtTheMeanIsTheNormaliser) {
  // log N(0; 0, diag(0.01, 0.04, 0.09)) = -(3 log 2 pi + log 3.6e-5) / 2, by hand.
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.04, 0.09).asDiagonal();
  const SO3d mean = SO3d::exp({0.3, -2.0, 0.7});
  const ConcentratedGaussian<SO3d> density(mean, covariance);
  EXPECT_NEAR(density.log_density(mean),
              -1.5 * std::log(2.0 * std::numbers::pi) - 0.5 * std::log(3.6e-5), 1e-12);
}

TYPED_TEST(ConcentratedGaussianOn, DensityAtTheMeanIsTheNormaliser) {
  testing::check_property([] {
    const auto density = testing::draw_gaussian<TypeParam>(1.5, 0.3);
    const Eigen::MatrixXd covariance = density.covariance();
    const double expected = -0.5 * (kLogTwoPi * static_cast<double>(density.dof()) +
                                    std::log(covariance.determinant()));
    RC_ASSERT(std::abs(density.log_density(density.mean()) - expected) < 1e-9);
  });
}

TYPED_TEST(ConcentratedGaussianOn, InversionKeepsTheDensity) {
  testing::check_property([] {
    const auto density = testing::draw_gaussian<TypeParam>(1.5, 0.3);
    const auto x = testing::draw_near_identity<TypeParam>(0.5) * density.mean();
    const double expected = density.log_density(x);
    const double actual = inverse(density).log_density(x.inverse());
    RC_ASSERT(std::abs(actual - expected) < 1e-9 * (1.0 + std::abs(expected)));
  });
}

TYPED_TEST(ConcentratedGaussianOn, BodyCovarianceIsThatOfTheRightPerturbation) {
  testing::check_property([] {
    const auto density = testing::draw_gaussian<TypeParam>(1.5, 0.3);
    // X = Exp(xi) X0 = X0 Exp(Ad(X0)^-1 xi).
    const Eigen::MatrixXd to_body = density.mean().adjoint().inverse();
    const Eigen::MatrixXd expected = to_body * density.covariance() * to_body.transpose();
    RC_ASSERT(testing::relative_difference(density.body_covariance(), expected) < 1e-12);
  });
}

TYPED_TEST(ConcentratedGaussianOn, EvaluatorAgreesWithTheDensity) {
  testing::check_property([] {
    const auto density = testing::draw_gaussian<TypeParam>(1.0, 0.2);
    const typename ConcentratedGaussian<TypeParam>::Evaluator evaluator(density);
    const auto x = testing::draw_near_identity<TypeParam>(1.0);
    RC_ASSERT(evaluator.log_density(x) == density.log_density(x));
  });
}

TEST(ConcentratedGaussian, ReleaseGivesMeanAndCovariance) {
  const Eigen::Matrix3d covariance = 0.04 * Eigen::Matrix3d::Identity();
  const SO3d mean = SO3d::exp({0.1, 0.2, 0.3});
  const auto [released, spread] = ConcentratedGaussian<SO3d>(mean, covariance).release();
  EXPECT_TRUE(released.is_approx(mean, 1e-15));
  EXPECT_EQ(spread, covariance);
}

/// det of sum_k ad(xi)^k / (k+1)!, the definition of J_l, in 50 digits.
Real volume_factor(const RealMatrix& ad) {
  RealMatrix term = RealMatrix::Identity(ad.rows(), ad.cols());
  RealMatrix sum = term;
  for (int k = 1; k < 120; ++k) {
    term = (term * ad / Real(k + 1)).eval();
    sum += term;
  }
  return sum.fullPivLu().determinant();
}

/// The defining formula of the density (midway-merge paper, eq. 5) in 50 digits.
template <class G, class RealGroup>
double exact_log_density(const ConcentratedGaussian<G>& density, const RealGroup& mean,
                         const RealGroup& element) {
  const RealMatrix p = density.covariance().template cast<Real>();
  const typename RealGroup::Tangent xi = (element * mean.inverse()).log();
  const Real squared = xi.dot(p.fullPivLu().solve(RealMatrix(xi)).col(0));
  const Real two_pi = 2 * boost::math::constants::pi<Real>();
  const Real log_normaliser =
      log(p.fullPivLu().determinant()) / 2 + Real(p.rows()) * log(two_pi) / 2;
  const Real volume = log(abs(volume_factor(RealGroup::ad(xi))));
  return static_cast<double>(-squared / 2 - log_normaliser - volume);
}

TEST(ConcentratedGaussian, RotationDensityAgreesWithFiftyDigits) {
  Eigen::Matrix3d covariance;
  covariance << 0.09, 0.02, -0.01, 0.02, 0.25, 0.05, -0.01, 0.05, 0.04;
  const SO3d mean = SO3d::exp({0.4, -0.8, 1.1});
  const ConcentratedGaussian<SO3d> density(mean, covariance);
  for (const double angle : {1e-9, 0.1, 1.0, 2.5, 3.14}) {
    const SO3d x = SO3d::exp(angle * Eigen::Vector3d(2, -1, 2) / 3.0) * mean;
    const double expected = exact_log_density(density, mean.cast<Real>(), x.cast<Real>());
    EXPECT_NEAR(density.log_density(x), expected, 1e-12 * std::abs(expected)) << angle;
  }
}

TEST(ConcentratedGaussian, PoseDensityAgreesWithFiftyDigits) {
  Matrix6d root = 0.2 * Matrix6d::Identity();
  root(3, 0) = 0.1;
  root(5, 2) = -0.15;
  root(4, 3) = 0.05;
  const Vector6d log_mean = (Vector6d() << 0.5, 1.1, -0.3, 2.0, -1.0, 0.5).finished();
  const SE3d mean = SE3d::exp(log_mean);
  const ConcentratedGaussian<SE3d> density(mean, root * root.transpose());
  const auto exact = [](const SE3d& x) {
    return SE3<Real>(x.rotation().cast<Real>(), x.translation().cast<Real>());
  };
  for (const double size : {1e-6, 0.3, 1.0, 2.9}) {
    const Vector6d xi = size * (Vector6d() << 2, -1, 2, 1, 3, -2).finished() / 3.0;
    const SE3d x = SE3d::exp(xi) * mean;
    const double expected = exact_log_density(density, exact(mean), exact(x));
    EXPECT_NEAR(density.log_density(x), expected, 1e-12 * (1.0 + std::abs(expected))) << size;
  }
}

}  // namespace
}  // namespace posemix
