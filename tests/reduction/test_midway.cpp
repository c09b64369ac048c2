// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/reduction/merge.hpp"
#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"

/// Theorems of the midway-merge paper about the midway point, on every group.
namespace posemix {
namespace {

using testing::check_property;
using testing::Components;
using testing::draw_components;
using testing::relative_difference;

template <class G>
class MidwayOn : public ::testing::Test {
 protected:
  static auto view(const Components<G>& components) {
    return std::span<const Component<ConcentratedGaussian<G>>>(components);
  }
};
using MidwayGroups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(MidwayOn, MidwayGroups);

/// Two to `most` components with the means of every pose within 1.5 rad of each other.
template <class G>
Components<G> draw_two_or_more(int most) {
  const auto count = static_cast<std::size_t>(testing::draw_integer(2, most + 1));
  return draw_components<G>(count, 0.4, 0.2);
}

TYPED_TEST(MidwayOn, MergedMeanIsZeroThere) {
  // Eq. 17 (eq. 15 at the point of eq. 12); for three components and more by iteration.
  check_property([] {
    const auto components = draw_two_or_more<TypeParam>(6);
    const auto midway = midway_point(MidwayOn<TypeParam>::view(components));
    RC_ASSERT(midway.converged);
    const auto merged = tangent_moments(MidwayOn<TypeParam>::view(components), midway.mean);
    RC_ASSERT(merged.mean.norm() < 1e-11);
  });
}

/// Weights, first mean and difference of the means of two components.
template <class G>
struct Two {
  explicit Two(const Components<G>& components)
      : w_1(std::exp(components[0].log_weight)),
        w_2(std::exp(components[1].log_weight)),
        x_1(components[0].density.mean()),
        dx((components[1].density.mean() * x_1.inverse()).log()) {}

  double w_1;
  double w_2;
  G x_1;
  typename G::Tangent dx;
};

TYPED_TEST(MidwayOn, DistancesObeyTheTheorem) {
  // Eq. 20-22: dx_1 = -w_2 dx, dx_2 = w_1 dx, so |dx_1|^2 + |dx_2|^2 = (w_1^2 + w_2^2) |dx|^2.
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(2, 0.8, 0.2);
    const auto [w_1, w_2, x_1, dx] = Two<G>(components);
    const auto midway = midway_point(MidwayOn<G>::view(components));
    const typename G::Tangent dx_1 = (x_1 * midway.mean.inverse()).log();
    const typename G::Tangent dx_2 = (components[1].density.mean() * midway.mean.inverse()).log();
    const double scale = 1.0 + dx.norm();
    RC_ASSERT((dx_1 + w_2 / (w_1 + w_2) * dx).norm() < 1e-11 * scale);
    RC_ASSERT((dx_2 - w_1 / (w_1 + w_2) * dx).norm() < 1e-11 * scale);
    const double rounding = 1e-14 * scale;
    RC_ASSERT(std::hypot(dx_1.norm(), dx_2.norm()) <= dx.norm() * (1.0 + 1e-12) + rounding);
  });
}

TYPED_TEST(MidwayOn, PointOfTwoIsTheInterpolation) {
  // Eq. 12: (X_2 X_1^-1)^w_2 X_1, without iteration.
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(2, 0.8, 0.2);
    const auto [w_1, w_2, x_1, dx] = Two<G>(components);
    const G expected = G::exp(w_2 / (w_1 + w_2) * dx) * x_1;
    const auto midway = midway_point(MidwayOn<G>::view(components));
    RC_ASSERT(midway.mean.is_approx(expected, 1e-12 * (1.0 + dx.norm())));
    RC_ASSERT(midway.iterations == 1);
  });
}

/// share J^-1 P J^-T with dense matrices.
Eigen::MatrixXd moved_back(const Eigen::MatrixXd& jacobian, double share,
                           const Eigen::MatrixXd& covariance) {
  const Eigen::MatrixXd inverse = jacobian.inverse();
  return share * inverse * covariance * inverse.transpose();
}

TYPED_TEST(MidwayOn, MergeIsThatOfThePaper) {
  // Eq. 13, 14, 18 and 19 with dense matrices.
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(2, 0.5, 0.2);
    const auto [w_1, w_2, x_1, dx] = Two<G>(components);
    const double share_1 = w_1 / (w_1 + w_2);
    const double share_2 = w_2 / (w_1 + w_2);
    const Eigen::MatrixXd expected =
        moved_back(G::left_jacobian(-share_2 * dx), share_1, components[0].density.covariance()) +
        moved_back(G::left_jacobian(share_1 * dx), share_2, components[1].density.covariance()) +
        share_1 * share_2 * dx * dx.transpose();
    const auto merged = merge(MidwayOn<G>::view(components)).component;
    RC_ASSERT(std::abs(merged.log_weight - std::log(w_1 + w_2)) < 1e-13);
    RC_ASSERT(merged.density.mean().is_approx(G::exp(share_2 * dx) * x_1, 1e-11));
    RC_ASSERT(relative_difference(merged.density.covariance(), expected) < 1e-10);
  });
}

TYPED_TEST(MidwayOn, SplittingAComponentChangesNothing) {
  // Three components of which two are the same pose with the same covariance are two components.
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(2, 0.4, 0.2);
    auto split = components;
    split[1].log_weight += std::log(0.25);
    split.push_back(components[1]);
    split[2].log_weight += std::log(0.75);
    const auto expected = merge(MidwayOn<G>::view(components)).component;
    const auto actual = merge(MidwayOn<G>::view(split));
    RC_ASSERT(actual.converged);
    RC_ASSERT(std::abs(actual.component.log_weight - expected.log_weight) < 1e-13);
    RC_ASSERT(actual.component.density.mean().is_approx(expected.density.mean(), 1e-10));
    RC_ASSERT(relative_difference(actual.component.density.covariance(),
                                  expected.density.covariance()) < 1e-9);
  });
}

TEST(Midway, ReportsWhenThePointHasNotConverged) {
  const Matrix6d p = 0.01 * Matrix6d::Identity();
  const Vector6d step = (Vector6d() << 0.9, -0.3, 0.4, 1.0, 2.0, -1.0).finished();
  const Vector6d other = (Vector6d() << -0.2, 0.8, 0.1, 0.5, -1.0, 2.0).finished();
  const Components<SE3d> components{
      {0.0, {SE3d(), p}}, {0.0, {SE3d::exp(step), p}}, {0.0, {SE3d::exp(other), p}}};
  const std::span<const Component<ConcentratedGaussian<SE3d>>> view(components);
  EXPECT_TRUE(midway_point(view).converged);
  const MergeSettings stopped{.max_iterations = 1};
  EXPECT_FALSE(midway_point(view, stopped).converged);
  EXPECT_FALSE(merge(view, stopped).converged);
  EXPECT_TRUE(merge(view).converged);
}

TEST(Midway, PointOfWeightlessComponentsCountsThemEqually) {
  const Matrix6d p = Matrix6d::Identity();
  const double none = -std::numeric_limits<double>::infinity();
  const Vector6d step = (Vector6d() << 0.6, 0.0, 0.3, 1.0, 0.0, 2.0).finished();
  Components<SE3d> components{{none, {SE3d(), p}}, {none, {SE3d::exp(step), p}}};
  const std::span<const Component<ConcentratedGaussian<SE3d>>> view(components);
  EXPECT_TRUE(midway_point(view).mean.is_approx(SE3d::exp(0.5 * step), 1e-14));
  components[0].log_weight = -3000.0;
  EXPECT_TRUE(midway_point(view).mean.is_approx(SE3d(), 1e-14));
}

TEST(Midway, PointOfNothingIsAnError) {
  const Components<SE3d> none;
  EXPECT_EQ(testing::thrown_message([&] {
              midway_point(std::span<const Component<ConcentratedGaussian<SE3d>>>(none));
            }),
            "midway_point: there is no component");
}

}  // namespace
}  // namespace posemix
