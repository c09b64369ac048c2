// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "law_suite.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix::testing {

/// The test of every group, those of test_stack_laws.cpp too.
TEST_P(LieLaw, Holds) { EXPECT_TRUE(holds(GetParam())); }

POSEMIX_TEST_LIE_LAWS(SO3d, 3, SO3d);
POSEMIX_TEST_LIE_LAWS(SO3f, 3, SO3<float>);
POSEMIX_TEST_LIE_LAWS(SE3d, 6, SE3d);
POSEMIX_TEST_LIE_LAWS(SE3f, 6, SE3<float>);
POSEMIX_TEST_LIE_LAWS(R3d, 3, Rnd<3>);

}  // namespace posemix::testing
