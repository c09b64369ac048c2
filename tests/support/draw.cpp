// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/testing/density_draw.hpp"

namespace posemix {

POSEMIX_SHOW_COMPONENT(, SO3d);
POSEMIX_SHOW_COMPONENT(, SE3d);
POSEMIX_SHOW_COMPONENT(, PoseStackd);
POSEMIX_SHOW_COMPONENT(, Rnd<3>);

namespace testing {

int draw_integer(int lowest, int end) { return *rc::gen::inRange(lowest, end); }

void check_property(const std::function<void()>& property) { rc::detail::checkGTest(property); }

POSEMIX_LIE_DRAW(, SO3d);
POSEMIX_LIE_DRAW(, SE3d);
POSEMIX_LIE_DRAW(, PoseStackd);
POSEMIX_LIE_DRAW(, Rnd<3>);
POSEMIX_DENSITY_DRAW(, SO3d);
POSEMIX_DENSITY_DRAW(, SE3d);
POSEMIX_DENSITY_DRAW(, PoseStackd);
POSEMIX_DENSITY_DRAW(, Rnd<3>);

}  // namespace testing
}  // namespace posemix
