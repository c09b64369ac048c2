// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/symmetry.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "posemix/testing/expect.hpp"
#include "symmetric_objects.hpp"

namespace posemix {
namespace {

using testing::Case;
using testing::cases;
using testing::cost;
using testing::draw;
using testing::isotropic;
using testing::kOff;
using testing::kPi;
using testing::kX;
using testing::kZ;
using testing::pose;
using testing::random_information;
using testing::random_motion;
using testing::sampled;
using testing::thrown_message;
using testing::turn;

TEST(SymmetryGroup, PutsTheIdentityFirstAndDropsDuplicates) {
  const SymmetryGroup group({turn(180, kZ), turn(180.2, kZ), SE3d(), turn(-180, kZ)});
  ASSERT_EQ(group.elements().size(), 2U);
  EXPECT_TRUE(group.elements()[0].is_approx(SE3d(), 0.0));
  EXPECT_TRUE(group.elements()[1].is_approx(turn(180, kZ), 1e-12));
  EXPECT_FALSE(group.is_trivial());
  EXPECT_TRUE(SymmetryGroup().is_trivial());
  EXPECT_TRUE(SymmetryGroup({SE3d()}).is_trivial());
}

TEST(SymmetryGroup, RefusesWhatIsNotClosed) {
  const std::string quarter = thrown_message([] { SymmetryGroup({turn(90, kZ)}); });
  EXPECT_NE(quarter.find("element 0 (90.0 deg about [0, 0, 1]"), std::string::npos) << quarter;
  EXPECT_NE(quarter.find("after element 0"), std::string::npos) << quarter;
  EXPECT_NE(quarter.find("180.0 deg"), std::string::npos) << quarter;
  // Two half turns about crossed axes need the third.
  const std::string box = thrown_message([] { SymmetryGroup({turn(180, kX), turn(180, kZ)}); });
  EXPECT_NE(box.find("element 0 "), std::string::npos) << box;
  EXPECT_NE(box.find("after element 1 "), std::string::npos) << box;
  // A half turn whose square is a shift of 3 cm: no involution.
  const SE3d screw = turn(180, kZ) * SE3d(SO3d(), 0.015 * kZ);
  EXPECT_NE(thrown_message([&] { SymmetryGroup({screw}); }), "");
  EXPECT_NE(thrown_message([] { SymmetryGroup({turn(177.7, kZ)}); }), "");
  EXPECT_EQ(thrown_message([] { SymmetryGroup({turn(179.8, kZ)}); }), "");
  EXPECT_NE(thrown_message([] { SymmetryGroup({turn(179.8, kZ)}, {}, {radians(0.1), 1e-3}); }), "");
}

TEST(SymmetryGroup, IsMadeAgainFromWhatIsStoredOfIt) {
  const SymmetryTolerance wide{radians(6.0), 1e-3};
  std::vector<SymmetryGroup> groups{SymmetryGroup({turn(178, kZ)}, {}, wide)};
  for (const Case& c : cases()) groups.push_back(c.group);
  RandomStream stream(9);
  for (const SymmetryGroup& group : groups) {
    const SymmetryGroup again = SymmetryGroup::from_stored(group.elements(), group.axes());
    ASSERT_EQ(again.elements().size(), group.elements().size());
    ASSERT_EQ(again.axes().size(), group.axes().size());
    const SE3d error = SE3d::exp(draw(isotropic(60.0, 0.1), stream));
    EXPECT_TRUE(again.reduced_error(error).is_approx(group.reduced_error(error), 1e-9));
    EXPECT_TRUE(again.unobserved_covariance().isApprox(group.unobserved_covariance(), 1e-12));
  }
  EXPECT_NE(thrown_message([] { SymmetryGroup::from_stored({}, {}); }), "");
  EXPECT_NE(thrown_message([] { SymmetryGroup::from_stored({turn(180, kZ)}, {}); }), "");
}

TEST(SymmetryGroup, RefusesAxesWithoutACommonPoint) {
  const Eigen::Vector3d up = kZ;
  const auto refuses = [](const std::vector<SymmetryAxis>& axes) {
    return thrown_message([&] { SymmetryGroup({}, axes); });
  };
  EXPECT_NE(refuses({{up, kOff}, {up, -kOff}}).find("axes 0 and 1"), std::string::npos);
  EXPECT_NE(refuses({{up, kOff}, {kX, -kOff}}).find("axes 0 and 1"), std::string::npos);
  EXPECT_NE(refuses({{up, kOff}, {kX, kOff}, {kX + up, -kOff}}).find("axes"), std::string::npos);
  EXPECT_NE(refuses({{Eigen::Vector3d::Zero(), kOff}}).find("axis 0"), std::string::npos);
  // One line given twice, once from another point and the other way round.
  EXPECT_EQ(SymmetryGroup({}, {{up, kOff}, {-2.0 * up, kOff + 0.3 * up}}).axes().size(), 1U);
}

TEST(SymmetryGroup, RefusesElementsThatMoveTheAxis) {
  const std::vector<SymmetryAxis> axis{{kZ, kOff}};
  const std::string tilted = thrown_message([&] { SymmetryGroup({turn(90, kX, kOff)}, axis); });
  EXPECT_NE(tilted.find("element 0"), std::string::npos) << tilted;
  EXPECT_NE(tilted.find("axis 0"), std::string::npos) << tilted;
  EXPECT_NE(thrown_message([&] { SymmetryGroup({turn(180, kX)}, axis); }), "");
  EXPECT_NE(thrown_message([&] {
              SymmetryGroup({SE3d(SO3d(), kX)}, {{kZ, kOff}, {kX, kOff}});
            }).find("common point"),
            std::string::npos);
}

TEST(SymmetryGroup, KeepsOneElementPerCosetOfTheAxis) {
  const SymmetryGroup can({turn(30, kZ), turn(180, kX), turn(180, Eigen::Vector3d(1, 1, 0))},
                          {{3.0 * kZ, 0.2 * kZ}});
  EXPECT_EQ(can.elements().size(), 2U);
  ASSERT_EQ(can.axes().size(), 1U);
  EXPECT_TRUE(can.axes()[0].direction.isApprox(kZ));
  EXPECT_LT(can.axes()[0].point.norm(), 1e-15);
  const SymmetryGroup ball({turn(77, Eigen::Vector3d(1, 2, 3))}, {{kZ, 0.2 * kZ}, {kX, {1, 0, 0}}});
  EXPECT_EQ(ball.elements().size(), 1U);
  EXPECT_EQ(ball.axes().size(), 3U);
  EXPECT_LT(ball.axes()[0].point.norm(), 1e-12);
}

TEST(SymmetryGroup, ClosestIsTheBestOfAFineGrid) {
  RandomStream stream(5);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    // A ball's grid of three angles is coarse: the grid's best lies above the optimum.
    const std::vector<SE3d> motions = sampled(c.group, c.group.axes().size() > 1 ? 15.0 : 0.25);
    for (int i = 0; i < 40; ++i) {
      const Matrix6d information = random_information(stream);
      const SE3d reference = pose(0.3, -0.2, 0.5, 0.4, 0.1, 1.2);
      const SE3d seen = reference * SE3d::exp(draw(isotropic(5.0, 0.02), stream)) *
                        random_motion(c.group, stream);
      const SE3d closest = c.group.closest(seen, reference, information);
      double least = std::numeric_limits<double>::infinity();
      for (const SE3d& g : motions) least = std::min(least, cost(seen * g, reference, information));
      EXPECT_LE(cost(closest, reference, information), least * (1 + 2e-6));
    }
  }
}

TEST(SymmetryGroup, ClosestIsAnEquivalentPose) {
  RandomStream stream(6);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const SE3d seen = pose(1.3, -0.2, 0.5, 0.4, 0.1, 1.2);
    const SE3d closest =
        c.group.closest(seen, pose(0.1, 0.2, 2.5, 0.3, 0.1, 1.0), random_information(stream));
    const SE3d g = seen.inverse() * closest;
    // An additional element outside the group would be kept, or refused.
    std::vector<SE3d> with{g};
    for (const SE3d& element : c.group.elements()) with.push_back(element);
    EXPECT_EQ(SymmetryGroup(with, c.group.axes(), {1e-7, 1e-7}).elements().size(),
              c.group.elements().size());
  }
}

/// No flip between equivalent poses: the closest pose is the same for all of them.
TEST(SymmetryGroup, ClosestIsTheSameForEquivalentPoses) {
  RandomStream stream(7);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    for (int i = 0; i < 200; ++i) {
      const Matrix6d information = random_information(stream);
      const SE3d reference = pose(-0.3, 0.7, 0.5, 0.4, 0.1, 1.2);
      const SE3d seen = reference * SE3d::exp(draw(isotropic(6.0, 0.02), stream));
      const SE3d other = seen * random_motion(c.group, stream);
      const SE3d a = c.group.closest(seen, reference, information);
      const SE3d b = c.group.closest(other, reference, information);
      // Both start from the same angle about the axis, so they differ by rounding errors only.
      EXPECT_TRUE(a.is_approx(b, 1e-9)) << (a.inverse() * b).log().transpose();
    }
  }
}

/// In Log a turn of the ball by half a turn turns its error by a quarter of one, and would let it
/// fall where little is known.
TEST(SymmetryGroup, WhatIsNotObservedMakesNoErrorSmaller) {
  const Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  const SymmetryGroup ball({}, {{kZ, centre}, {kX, centre}});
  const Matrix6d covariance =
      pose_covariance(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.01, 0.01, 0.2));
  const Matrix6d information = (covariance + ball.unobserved_covariance()).inverse();
  RandomStream stream(8);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d aside(0.1, 0.0, 0.0);
    const SE3d seen(SO3d::exp(2.0 * Eigen::Vector3d(stream.normal(), stream.normal(), 1.0)), aside);
    const SE3d nearest = ball.closest_observed(seen, SE3d(), information);
    EXPECT_NEAR(cost(nearest, SE3d(), information), 100.0, 1e-6);
  }
}

/// Squared Mahalanobis distance of what is observed: across the directions in which a turn about an
/// axis moves the pose.
double cost_of_observed(const SymmetryGroup& group, const SE3d& seen, const SE3d& reference,
                        const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(group.unobserved_covariance());
  const auto dof = static_cast<Eigen::Index>(6 - group.axes().size());
  const Eigen::MatrixXd across = eigen.eigenvectors().leftCols(dof);
  const Eigen::VectorXd z = across.transpose() * (seen.inverse() * reference).log();
  const Eigen::MatrixXd covariance = across.transpose() * information.inverse() * across;
  return z.dot(covariance.llt().solve(z));
}

/// And with a tilt that is observed, for all groups: no rotation about the axes is left, and the
/// cost is that of what is observed.
TEST(SymmetryGroup, ClosestObservedHasNoRotationAboutTheAxes) {
  RandomStream stream(9);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    for (int i = 0; i < 50; ++i) {
      const Matrix6d information =
          (random_information(stream).inverse() + c.group.unobserved_covariance()).inverse();
      const SE3d reference = pose(0.3, -0.2, 0.5, 0.4, 0.1, 1.2);
      const SE3d truth = reference * SE3d::exp(draw(isotropic(5.0, 0.02), stream));
      const SE3d seen = truth * random_motion(c.group, stream);
      const SE3d nearest = c.group.closest_observed(seen, reference, information);
      const Eigen::Vector3d left = (nearest.inverse() * reference).rotation().log();
      for (const SymmetryAxis& axis : c.group.axes())
        EXPECT_NEAR(left.dot(axis.direction), 0.0, 1e-9);
      const SE3d best = c.group.closest(seen, reference, information);
      EXPECT_TRUE(c.group.closest_observed(best, reference, information).is_approx(nearest, 1e-9));
      const double observed = cost_of_observed(c.group, nearest, reference, information);
      EXPECT_LT(cost(nearest, reference, information), 1.01 * observed + 0.01);
      EXPECT_GE(cost(nearest, reference, information), observed - 1e-9);
    }
  }
}

TEST(SymmetryGroup, AngleIsRefinedWhereTheAxisIsOffTheOrigin) {
  // A line one metre away: the position determines the angle better than the rotation does.
  const SymmetryGroup group({}, {{kZ, Eigen::Vector3d(1, 0, 0)}});
  const Matrix6d information = isotropic(20.0, 0.001).inverse();
  const SE3d reference;
  const SE3d truth = SE3d(SO3d::exp(radians(10.0) * kZ), Eigen::Vector3d::Zero());
  const SE3d closest = group.closest(truth, reference, information);
  double least = std::numeric_limits<double>::infinity();
  for (const SE3d& g : sampled(group, 0.001))
    least = std::min(least, cost(truth * g, reference, information));
  EXPECT_LE(cost(closest, reference, information), least * (1 + 2e-6));
}

TEST(SymmetryGroup, UnobservedCovarianceIsOfAUniformAngle) {
  EXPECT_TRUE(SymmetryGroup({turn(180, kZ)}).unobserved_covariance().isZero());
  const double variance = kPi * kPi / 3.0;
  Matrix6d about_z = Matrix6d::Zero();
  about_z(2, 2) = variance;
  EXPECT_TRUE(SymmetryGroup({}, {{kZ, kZ}}).unobserved_covariance().isApprox(about_z, 1e-12));
  // A small turn about the line moves the origin by angle d x (0 - p): here along -y.
  const SymmetryGroup off({}, {{kZ, Eigen::Vector3d(0.1, 0, 0)}});
  Vector6d twist = Vector6d::Zero();
  twist[2] = 1.0;
  twist[4] = (turn(1e-6 * 180 / kPi, kZ, {0.1, 0, 0}).translation() / 1e-6).y();
  EXPECT_LT((off.unobserved_covariance() - variance * twist * twist.transpose()).norm(), 1e-8);
  const SymmetryGroup ball({}, {{kX, Eigen::Vector3d::Zero()}, {kZ, Eigen::Vector3d::Zero()}});
  Matrix6d rotations = Matrix6d::Zero();
  rotations.topLeftCorner<3, 3>() = variance * Eigen::Matrix3d::Identity();
  EXPECT_TRUE(ball.unobserved_covariance().isApprox(rotations, 1e-12));
}

}  // namespace
}  // namespace posemix
