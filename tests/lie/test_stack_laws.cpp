// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "law_suite.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix::testing {

POSEMIX_TEST_LIE_LAWS(PoseStack1, 6, PoseStackd);
POSEMIX_TEST_LIE_LAWS(PoseStack2, 12, PoseStackd);
POSEMIX_TEST_LIE_LAWS(PoseStack3, 18, PoseStackd);
POSEMIX_TEST_LIE_LAWS(PoseStack4, 24, PoseStackd);
POSEMIX_TEST_LIE_LAWS(PoseStack2f, 12, PoseStack<float>);
POSEMIX_TEST_LIE_LAWS(R5, 5, Rnd<Eigen::Dynamic>);

}  // namespace posemix::testing
