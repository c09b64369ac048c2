// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/moments.hpp"

namespace posemix {

POSEMIX_TANGENT_MOMENTS(, SO3d);
POSEMIX_TANGENT_MOMENTS(, SE3d);
POSEMIX_TANGENT_MOMENTS(, PoseStackd);
POSEMIX_TANGENT_MOMENTS(, Rnd<3>);

POSEMIX_MOMENTS(, SO3d);
POSEMIX_MOMENTS(, SE3d);
POSEMIX_MOMENTS(, PoseStackd);
POSEMIX_MOMENTS(, Rnd<3>);

}  // namespace posemix
