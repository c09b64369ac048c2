// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "posemix/detector/symmetry.hpp"
#include "posemix/testing/expect.hpp"
#include "symmetric_objects.hpp"

namespace posemix {
namespace {

using testing::Case;
using testing::cases;
using testing::draw;
using testing::isotropic;
using testing::kPi;
using testing::kZ;
using testing::sampled;
using testing::thrown_message;

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
  // Steps of half a degree are within the tolerance.
  EXPECT_EQ(SymmetryGroup::turns(kZ, 719).elements().size(), 719U);
  for (const int fold : {720, 721, 1000}) {
    const std::string message = thrown_message([&] { SymmetryGroup::turns(kZ, fold); });
    EXPECT_NE(message.find("at most 719"), std::string::npos) << message;
  }
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
