// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/merge.hpp"

namespace posemix {

POSEMIX_MERGE(, SO3d);
POSEMIX_MERGE(, SE3d);
POSEMIX_MERGE(, PoseStackd);
POSEMIX_MERGE(, Rnd<3>);

}  // namespace posemix
