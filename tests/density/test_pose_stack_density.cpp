// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/density/pose_stack.hpp"

#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "posemix/density/operations.hpp"
#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"
#include "posemix/testing/statistics.hpp"

namespace posemix {
namespace {

using testing::check_property;
using testing::relative_difference;
using testing::thrown_message;
using Joint = ConcentratedGaussian<PoseStackd>;
using Indices = std::vector<std::size_t>;

Joint draw_joint(double deviation) { return testing::draw_gaussian<PoseStackd>(1.0, deviation); }

/// Rows of the tangent vector that belong to the poses at `indices`.
std::vector<Eigen::Index> rows_of(const Indices& indices) {
  std::vector<Eigen::Index> rows;
  for (const std::size_t index : indices) {
    for (Eigen::Index k = 0; k < 6; ++k) rows.push_back(static_cast<Eigen::Index>(6 * index) + k);
  }
  return rows;
}

TEST(PoseStackDensity, MarginalSelectsPosesAndBlocksInTheGivenOrder) {
  check_property([] {
    const Joint joint = draw_joint(0.3);
    const Indices indices{2, 0};
    const Joint part = marginal(joint, indices);
    const auto rows = rows_of(indices);
    const Eigen::MatrixXd expected = joint.covariance()(rows, rows);
    RC_ASSERT(part.mean().size() == 2U);
    RC_ASSERT(part.mean()[0].is_approx(joint.mean()[2], 1e-15));
    RC_ASSERT(part.mean()[1].is_approx(joint.mean()[0], 1e-15));
    RC_ASSERT(part.covariance() == expected);
  });
}

TEST(PoseStackDensity, MarginalOfOnePose) {
  check_property([] {
    const Joint joint = draw_joint(0.3);
    const ConcentratedGaussian<SE3d> part = marginal(joint, 1);
    const Eigen::MatrixXd expected = joint.covariance().block(6, 6, 6, 6);
    RC_ASSERT(part.mean().is_approx(joint.mean()[1], 1e-15));
    RC_ASSERT(Eigen::MatrixXd(part.covariance()) == expected);
  });
}

TEST(PoseStackDensity, ConditionalIsThatOfDenseLinearAlgebra) {
  check_property([] {
    const Joint joint = draw_joint(0.2);
    const Eigen::VectorXd deviation = testing::draw_vector<double, Eigen::Dynamic>(12, 1e-4);
    const Indices given{2, 0};
    const std::vector<SE3d> values{SE3d::exp(deviation.head<6>()) * joint.mean()[2],
                                   SE3d::exp(deviation.tail<6>()) * joint.mean()[0]};
    const Joint rest = conditional(joint, given, values);
    // The information form: P^-1 partitioned, conditional covariance (P^-1)_bb^-1, mean
    // -(P^-1)_bb^-1 (P^-1)_ba xi_a.
    const Eigen::MatrixXd information = joint.covariance().inverse();
    const auto a = rows_of(given);
    const auto b = rows_of({1});
    const Eigen::MatrixXd info_bb = information(b, b);
    const Eigen::MatrixXd info_ba = information(b, a);
    const Eigen::VectorXd mean = -info_bb.inverse() * (info_ba * deviation);
    RC_ASSERT(rest.mean().size() == 1U);
    const Eigen::VectorXd moved = (rest.mean()[0] * joint.mean()[1].inverse()).log();
    RC_ASSERT((moved - mean).norm() < 1e-10);
    // Back-projection changes the covariance by a relative |mean|, about 1e-4.
    RC_ASSERT(relative_difference(rest.covariance(), info_bb.inverse()) < 1e-2);
    const Eigen::MatrixXd jacobian = SE3d::left_jacobian(mean);
    const Eigen::MatrixXd projected = jacobian * info_bb.inverse() * jacobian.transpose();
    RC_ASSERT(relative_difference(rest.covariance(), projected) < 1e-9);
  });
}

TEST(PoseStackDensity, ConditionalAtTheMeanKeepsTheMean) {
  check_property([] {
    const Joint joint = draw_joint(0.3);
    const std::vector<SE3d> values{joint.mean()[1]};
    const Joint rest = conditional(joint, Indices{1}, values);
    RC_ASSERT(rest.mean().size() == 2U);
    RC_ASSERT(rest.mean()[0].is_approx(joint.mean()[0], 1e-13));
    RC_ASSERT(rest.mean()[1].is_approx(joint.mean()[2], 1e-13));
  });
}

TEST(PoseStackDensity, ConditionalOnNothingIsTheJoint) {
  const Joint joint(PoseStackd(2), Eigen::MatrixXd::Identity(12, 12));
  const Joint same = conditional(joint, Indices{}, std::vector<SE3d>{});
  EXPECT_EQ(same.mean().size(), 2U);
  EXPECT_EQ(same.covariance(), joint.covariance());
}

TEST(PoseStackDensity, IndependentPosesAreConditionedOnNothing) {
  const Eigen::MatrixXd covariance = 0.04 * Eigen::MatrixXd::Identity(12, 12);
  const Joint joint(PoseStackd(2), covariance);
  const std::vector<SE3d> values{SE3d::exp(Vector6d::Constant(0.3))};
  const Joint rest = conditional(joint, Indices{0}, values);
  EXPECT_TRUE(rest.mean()[0].is_approx(SE3d(), 1e-15));
  EXPECT_TRUE(
      testing::matrices_near(rest.covariance(), 0.04 * Eigen::MatrixXd::Identity(6, 6), 1e-15));
}

TEST(PoseStackDensity, RelativePoseUsesTheCrossCovariance) {
  // Two poses with a common error: their relative pose is more certain than either.
  const Matrix6d common = 0.25 * Matrix6d::Identity();
  const Matrix6d own = 1e-4 * Matrix6d::Identity();
  Eigen::MatrixXd covariance(12, 12);
  covariance << common + own, common, common, common + own;
  const SE3d from = SE3d::exp((Vector6d() << 0.4, -1.0, 0.3, 1.0, 2.0, -1.0).finished());
  const SE3d to = SE3d::exp((Vector6d() << -0.2, 0.5, 1.3, -0.5, 1.0, 0.2).finished());
  const Joint joint(PoseStackd({from, to}), covariance);
  const auto relative = relative_pose(joint, 0, 1);
  EXPECT_TRUE(relative.mean().is_approx(from.inverse() * to, 1e-14));
  const Eigen::MatrixXd adjoint = from.inverse().adjoint();
  EXPECT_TRUE(
      testing::matrices_near(relative.covariance(), 2e-4 * adjoint * adjoint.transpose(), 1e-15));
  // `between` of the two marginals assumes independence and loses that.
  const auto independent = between(marginal(joint, 0), marginal(joint, 1));
  EXPECT_GT(independent.covariance().trace(), 1000.0 * relative.covariance().trace());
}

TEST(PoseStackDensity, RelativePoseOfIndependentPosesIsBetween) {
  check_property([] {
    const auto x = testing::draw_gaussian<SE3d>(1.0, 0.3);
    const auto y = testing::draw_gaussian<SE3d>(1.0, 0.3);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(12, 12);
    covariance.topLeftCorner(6, 6) = x.covariance();
    covariance.bottomRightCorner(6, 6) = y.covariance();
    const Joint joint(PoseStackd({x.mean(), y.mean()}), covariance);
    const auto expected = between(x, y);
    const auto relative = relative_pose(joint, 0, 1);
    RC_ASSERT(relative.mean().is_approx(expected.mean(), 1e-13));
    RC_ASSERT(relative_difference(relative.covariance(), expected.covariance()) < 1e-12);
  });
}

TEST(PoseStackDensity, RelativePoseAgreesWithMonteCarlo) {
  // 40,000 draws; deviations near 0.02 leave nonlinear terms of relative size 4e-4.
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(18, 18);
  for (Eigen::Index i = 6; i < 18; ++i) root(i, i - 6) = 0.8;
  PoseStackd::Tangent log_mean(18);
  for (Eigen::Index i = 0; i < 18; ++i) log_mean[i] = std::cos(1.0 + 2.0 * static_cast<double>(i));
  const Joint joint(PoseStackd::exp(log_mean), 4e-4 * root * root.transpose());
  const auto relative = relative_pose(joint, 2, 1);
  const SE3d inverse_mean = relative.mean().inverse();
  testing::SampleMoments moments(6);
  RandomStream stream(21);
  for (int i = 0; i < 40'000; ++i) {
    const PoseStackd poses = joint.sample(stream);
    moments.add((poses[2].inverse() * poses[1] * inverse_mean).log());
  }
  EXPECT_LT(moments.worst_score(Vector6d::Zero(), relative.covariance(), 2e-3), 4.5);
}

TEST(PoseStackDensity, RejectsUnusableIndices) {
  const Joint joint(PoseStackd(2), Eigen::MatrixXd::Identity(12, 12));
  const std::vector<SE3d> one(1);
  const std::vector<SE3d> two(2);
  const std::string range = "pose index 2 is out of range, the joint density has 2 poses";
  const std::string twice = "pose index 1 occurs twice";
  EXPECT_EQ(thrown_message([&] { marginal(joint, 2); }), range);
  EXPECT_EQ(thrown_message([&] { marginal(joint, Indices{0, 2}); }), range);
  EXPECT_EQ(thrown_message([&] { marginal(joint, Indices{1, 1}); }), twice);
  EXPECT_EQ(thrown_message([&] { conditional(joint, Indices{2}, one); }), range);
  EXPECT_EQ(thrown_message([&] { conditional(joint, Indices{1, 1}, two); }), twice);
  EXPECT_EQ(thrown_message([&] { conditional(joint, Indices{1}, two); }),
            "2 values for 1 pose indices");
  EXPECT_EQ(thrown_message([&] {
              conditional(joint, Indices{0, 1}, two);
            }),
            "conditional: every pose is given, none is left");
  EXPECT_EQ(thrown_message([&] { relative_pose(joint, 0, 2); }), range);
  EXPECT_EQ(thrown_message([&] { relative_pose(joint, 1, 1); }), twice);
}

}  // namespace
}  // namespace posemix
