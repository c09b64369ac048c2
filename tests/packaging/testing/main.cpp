// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <posemix/testing/data.hpp>
#include <posemix/testing/density_draw.hpp>
#include <posemix/testing/expect.hpp>
#include <posemix/testing/lie_check.hpp>
#include <posemix/testing/lie_draw.hpp>
#include <posemix/testing/lie_laws.hpp>
#include <posemix/testing/mutate.hpp>
#include <posemix/testing/numeric_jacobian.hpp>
#include <posemix/testing/rotation_quadrature.hpp>
#include <posemix/testing/statistics.hpp>

namespace posemix::testing {
namespace {

TEST(Expectations, AreThereForUsers) {
  EXPECT_EQ(thrown_message([] { throw InvalidInput("no pose"); }), "no pose");
  EXPECT_TRUE(matrices_near(SE3d().matrix(), Eigen::Matrix4d::Identity(), 0.0));
}

}  // namespace
}  // namespace posemix::testing
