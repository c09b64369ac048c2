// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/lie.hpp"

namespace posemix {

POSEMIX_LIE(, SO3d);
POSEMIX_LIE(, SE3d);
POSEMIX_LIE(, PoseStackd);
POSEMIX_LIE(, Rnd<3>);

}  // namespace posemix
