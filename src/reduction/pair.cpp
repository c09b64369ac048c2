// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/pair.hpp"

namespace posemix {

POSEMIX_PAIR(, SO3d);
POSEMIX_PAIR(, SE3d);
POSEMIX_PAIR(, PoseStackd);
POSEMIX_PAIR(, Rnd<3>);

}  // namespace posemix
