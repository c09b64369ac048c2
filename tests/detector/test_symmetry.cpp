// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/symmetry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "posemix/base/random.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::thrown_message;

SE3d pose(double rx, double ry, double rz, double x, double y, double z) {
  Vector6d xi;
  xi << rx, ry, rz, x, y, z;
  return SE3d::exp(xi);
}

Matrix6d isotropic(double rotation_sd_deg, double translation_sd_m) {
  Vector6d sd;
  sd << Eigen::Vector3d::Constant(radians(rotation_sd_deg)),
      Eigen::Vector3d::Constant(translation_sd_m);
  return sd.cwiseAbs2().asDiagonal();
}

/// A draw of N(0, covariance).
Vector6d draw(const Matrix6d& covariance, RandomStream& stream) {
  Eigen::VectorXd white(6);
  stream.fill_normal(white);
  return Eigen::LLT<Matrix6d>(covariance).matrixL() * white;
}

constexpr double kPi = std::numbers::pi;

SE3d turn(double degrees, const Eigen::Vector3d& axis,
          const Eigen::Vector3d& point = Eigen::Vector3d::Zero()) {
  const SO3d rotation = SO3d::exp(radians(degrees) * axis.normalized());
  return SE3d(rotation, point - rotation * point);
}

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();
const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();
const Eigen::Vector3d kOff(0.03, -0.02, 0.01);

/// A scene's worth of different groups: what the object may be turned by, as matrices.
struct Case {
  const char* name;
  SymmetryGroup group;
};

std::vector<Case> cases() {
  return {
      {"trivial", SymmetryGroup()},
      {"half turn about a line off the origin", SymmetryGroup({turn(180, kZ, kOff)})},
      {"quarter turns", SymmetryGroup({turn(90, kZ), turn(180, kZ), turn(270, kZ)})},
      {"box", SymmetryGroup({turn(180, kX), turn(180, kZ), turn(180, kX.cross(kZ))})},
      {"axis", SymmetryGroup({}, {{kZ, kOff}})},
      {"can", SymmetryGroup({turn(180, kX, kOff)}, {{kZ, kOff}})},
      {"ball", SymmetryGroup({}, {{kX, kOff}, {kZ, kOff}})},
  };
}

double cost(const SE3d& pose, const SE3d& reference, const Matrix6d& information) {
  const Vector6d z = (pose.inverse() * reference).log();
  return z.dot(information * z);
}

/// All motions of a group, angles about axes in steps.
std::vector<SE3d> sampled(const SymmetryGroup& group, double step_deg) {
  std::vector<SE3d> turns{SE3d()};
  for (const SymmetryAxis& axis : group.axes()) {
    std::vector<SE3d> more;
    for (const SE3d& before : turns)
      for (double angle = 0; angle < 360; angle += step_deg)
        more.push_back(before * turn(angle, axis.direction, axis.point));
    turns = more;
  }
  std::vector<SE3d> all;
  for (const SE3d& element : group.elements())
    for (const SE3d& k : turns) all.push_back(element * k);
  return all;
}

Matrix6d random_information(RandomStream& stream) {
  Matrix6d root;
  for (double& entry : root.reshaped()) entry = stream.normal();
  const Matrix6d scale = isotropic(4.0, 0.01).cwiseSqrt();
  const Matrix6d covariance =
      scale * (0.2 * root * root.transpose() + Matrix6d::Identity()) * scale;
  return covariance.inverse();
}

SE3d random_motion(const SymmetryGroup& group, RandomStream& stream) {
  const auto& elements = group.elements();
  SE3d motion =
      elements[static_cast<std::size_t>(stream.uniform() * static_cast<double>(elements.size()))];
  for (const SymmetryAxis& axis : group.axes())
    motion = motion * turn(360 * stream.uniform(), axis.direction, axis.point);
  return motion;
}

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
    // One more element that is none of the group's would be kept, or refused.
    std::vector<SE3d> with{g};
    for (const SE3d& element : c.group.elements()) with.push_back(element);
    EXPECT_EQ(SymmetryGroup(with, c.group.axes(), {1e-7, 1e-7}).elements().size(),
              c.group.elements().size());
  }
}

/// No flip between equivalent poses: whichever of them is seen, the closest one is the same.
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
      // Both start from the same angle about the axis: nothing but rounding is between them.
      EXPECT_TRUE(a.is_approx(b, 1e-9)) << (a.inverse() * b).log().transpose();
    }
  }
}

TEST(SymmetryGroup, AngleIsRefinedWhereTheAxisIsOffTheOrigin) {
  // A line one metre away: the position says more of the angle than the rotation does.
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

TEST(SymmetryGroup, ReducedErrorsHaveTheTurnTakenOut) {
  RandomStream stream(5);
  const SymmetryGroup can = SymmetryGroup::turns(kZ, 0);
  const SymmetryGroup box = SymmetryGroup::turns(kZ, 2);
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd z(6);
    stream.fill_normal(z);
    const SE3d error = SE3d::exp(Vector6d(z));
    const SE3d reduced = can.reduced_error(error);
    EXPECT_NEAR(reduced.rotation().quaternion().z(), 0.0, 1e-12);
    const SE3d undone = reduced * error.inverse();  // a turn about the true object's axis
    EXPECT_NEAR(undone.rotation().log().head<2>().norm(), 0.0, 1e-12);
    EXPECT_NEAR(undone.translation().norm(), 0.0, 1e-12);
    const SE3d half = box.reduced_error(error);
    EXPECT_LE(half.rotation().log().norm(), error.rotation().log().norm() + 1e-12);
    EXPECT_LE(2.0 * std::abs(std::atan2(half.rotation().quaternion().z(),
                                        std::abs(half.rotation().quaternion().w()))),
              kPi / 2.0 + 1e-12);
    const SE3d nearest = can.nearest_rotation(error, SE3d());
    EXPECT_NEAR(nearest.rotation().quaternion().z(), 0.0, 1e-12);
    EXPECT_LT((nearest.translation() - error.translation()).norm(), 1e-12);
  }
}

/// The closed form of turns() and the search over elements give the same.
TEST(SymmetryGroup, TurnsAreTheGroupOfTheirElements) {
  RandomStream stream(8);
  for (const int fold : {0, 1, 2, 3, 6}) {
    const Eigen::Vector3d axis(0.2, -1.0, 0.4);
    const SymmetryGroup turns = SymmetryGroup::turns(axis, fold);
    EXPECT_EQ(turns.elements().size(), fold == 0 ? 1U : static_cast<std::size_t>(fold));
    EXPECT_EQ(turns.axes().size(), fold == 0 ? 1U : 0U);
    const SymmetryGroup searched(turns.elements(), turns.axes());
    for (int i = 0; i < 50; ++i) {
      const SE3d a = SE3d::exp(draw(isotropic(60.0, 0.1), stream));
      const SE3d b = SE3d::exp(draw(isotropic(60.0, 0.1), stream));
      EXPECT_TRUE(turns.reduced_error(a).is_approx(searched.reduced_error(a), 1e-12));
      EXPECT_TRUE(turns.nearest_rotation(a, b).is_approx(searched.nearest_rotation(a, b), 1e-12));
    }
  }
  EXPECT_NE(thrown_message([] { SymmetryGroup::turns(kZ, -1); }).find("-1 turns"),
            std::string::npos);
  EXPECT_NE(thrown_message([] { SymmetryGroup::turns(Eigen::Vector3d::Zero(), 4); }), "");
}

/// Oracle: all motions of the group on a grid.
TEST(SymmetryGroup, NearestRotationIsTheBestOfAFineGrid) {
  RandomStream stream(9);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const std::vector<SE3d> motions = sampled(c.group, c.group.axes().size() > 1 ? 15.0 : 0.25);
    for (int i = 0; i < 20; ++i) {
      const SE3d reference = SE3d::exp(draw(isotropic(90.0, 0.1), stream));
      const SE3d seen = SE3d::exp(draw(isotropic(90.0, 0.1), stream));
      const auto angle = [&](const SE3d& to) {
        return (to.rotation().inverse() * reference.rotation()).angle();
      };
      double least = std::numeric_limits<double>::infinity();
      for (const SE3d& g : motions) least = std::min(least, angle(seen * g));
      EXPECT_LE(angle(c.group.nearest_rotation(seen, reference)), least + 1e-9);
      // With the truth seen and the reference as estimate, the reduced error is that rotation.
      const SE3d error = seen.inverse() * reference;
      EXPECT_LE(c.group.reduced_error(error).rotation().angle(), least + 1e-9);
    }
  }
}

}  // namespace
}  // namespace posemix
