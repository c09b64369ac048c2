// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/tangent_moments.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::check_property;
using testing::Components;
using testing::draw_components;
using testing::relative_difference;
using testing::thrown_message;

template <class G>
std::span<const Component<ConcentratedGaussian<G>>> view(const Components<G>& components) {
  return components;
}

template <class G>
class TangentMomentsOn : public ::testing::Test {};
using TangentGroups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(TangentMomentsOn, TangentGroups);

TYPED_TEST(TangentMomentsOn, MatchTheMomentsOfTheMovedComponents) {
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(3, 0.4, 0.2);
    const G anchor = testing::draw_near_identity<G>(0.2) * components[0].density.mean();
    // Midway-merge paper, eq. 8, in the centred form and with dense Jacobians:
    // P = sum w_i (J_i^-1 P_i J_i^-T + (d_i - d)(d_i - d)^T).
    double total = 0.0;
    for (const auto& c : components) total += std::exp(c.log_weight);
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(anchor.dof());
    for (const auto& c : components) {
      mean += std::exp(c.log_weight) / total * (c.density.mean() * anchor.inverse()).log();
    }
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(anchor.dof(), anchor.dof());
    for (const auto& c : components) {
      const typename G::Tangent d = (c.density.mean() * anchor.inverse()).log();
      const Eigen::MatrixXd jacobian = G::left_jacobian_inverse(d);
      covariance += std::exp(c.log_weight) / total *
                    (jacobian * c.density.covariance() * jacobian.transpose() +
                     (d - mean) * (d - mean).transpose());
    }
    const auto merged = tangent_moments(view<G>(components), anchor);
    RC_ASSERT((merged.mean - mean).norm() < 1e-12);
    RC_ASSERT(relative_difference(merged.covariance, covariance) < 1e-11);
    RC_ASSERT(merged.covariance == merged.covariance.transpose());
  });
}

TYPED_TEST(TangentMomentsOn, ScaleOfTheWeightsDoesNotMatter) {
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(3, 0.4, 0.2);
    auto scaled = components;
    for (auto& c : scaled) c.log_weight -= 2000.0;
    const G anchor = components[0].density.mean();
    const auto expected = tangent_moments(view<G>(components), anchor);
    const auto actual = tangent_moments(view<G>(scaled), anchor);
    RC_ASSERT((actual.mean - expected.mean).norm() < 1e-11);
    RC_ASSERT(relative_difference(actual.covariance, expected.covariance) < 1e-10);
  });
}

TYPED_TEST(TangentMomentsOn, ComponentsWithoutWeightDoNotCount) {
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(2, 0.4, 0.2);
    auto longer = components;
    longer.push_back(
        {-std::numeric_limits<double>::infinity(), testing::draw_gaussian<G>(1.0, 1.0)});
    const G anchor = components[0].density.mean();
    const auto expected = tangent_moments(view<G>(components), anchor);
    RC_ASSERT(tangent_moments(view<G>(longer), anchor).covariance == expected.covariance);
  });
}

TEST(TangentMoments, RejectsWhatHasNoMoments) {
  const Components<SO3d> none;
  EXPECT_EQ(thrown_message([&] { tangent_moments(view<SO3d>(none), SO3d()); }),
            "tangent_moments: there is no component");
  const ConcentratedGaussian<SO3d> density(SO3d(), Eigen::Matrix3d::Identity());
  const Components<SO3d> weightless{{-std::numeric_limits<double>::infinity(), density}};
  EXPECT_EQ(thrown_message([&] { tangent_moments(view<SO3d>(weightless), SO3d()); }),
            "all weights are zero");
}

/// Norm of the difference between the Bernoulli series and the exact J_l^-1 at an angle.
double series_error(double angle) {
  const Eigen::Vector3d phi = angle * Eigen::Vector3d(2, -1, 2) / 3.0;
  return (bernoulli_left_jacobian_inverse<SO3d>(phi) - SO3d::left_jacobian_inverse(phi))
      .jacobiSvd()
      .singularValues()[0];
}

TEST(BernoulliTransport, SeriesErrorIsThatOfTheFirstOmittedTerm) {
  // x / (e^x - 1) = 1 - x/2 + x^2/12 - x^4/720 + x^6/30240 - x^8/1209600 + ...: with x = i angle on
  // the plane across the axis the error is angle^6/30240 (1 + angle^2/40 + ...).
  for (const double angle : {0.1, 0.5, 1.0}) {
    const double expected = std::pow(angle, 6) / 30240.0 * (1.0 + angle * angle / 40.0);
    EXPECT_NEAR(series_error(angle) / expected, 1.0, 2e-3) << angle;
  }
  // The sizes that the documentation states.
  EXPECT_NEAR(series_error(0.1), 3e-11, 0.5e-11);
  EXPECT_NEAR(series_error(0.5), 5e-7, 0.5e-7);
  EXPECT_NEAR(series_error(3.0), 3e-2, 0.5e-2);
}

TYPED_TEST(TangentMomentsOn, BernoulliTransportIsExactAtSmallAngles) {
  check_property([] {
    using G = TypeParam;
    const auto density = testing::draw_gaussian<G>(1.0, 0.3);
    const G anchor = testing::draw_near_identity<G>(0.05) * density.mean();
    const auto exact = recenter(density, anchor, TransportJacobian::exact);
    const auto series = recenter(density, anchor, TransportJacobian::bernoulli);
    RC_ASSERT((series.mean - exact.mean).norm() == 0.0);
    RC_ASSERT(relative_difference(series.covariance, exact.covariance) < 1e-9);
    RC_ASSERT(exact.covariance == recenter(density, anchor).covariance);
  });
}

TEST(BernoulliTransport, DiffersFromTheExactOneAtLargeAngles) {
  const ConcentratedGaussian<SE3d> density(SE3d::exp(Vector6d::Constant(1.5)),
                                           Matrix6d::Identity());
  const auto exact = recenter(density, SE3d(), TransportJacobian::exact);
  const auto series = recenter(density, SE3d(), TransportJacobian::bernoulli);
  const double difference = relative_difference(series.covariance, exact.covariance);
  EXPECT_GT(difference, 1e-3);
  EXPECT_LT(difference, 0.2);
}

}  // namespace
}  // namespace posemix
