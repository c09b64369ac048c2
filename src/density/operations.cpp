// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/density/operations.hpp"

namespace posemix {

POSEMIX_DENSITY_OPERATIONS(, SO3d);
POSEMIX_DENSITY_OPERATIONS(, SE3d);
POSEMIX_DENSITY_OPERATIONS(, PoseStackd);
POSEMIX_DENSITY_OPERATIONS(, Rnd<3>);

}  // namespace posemix
