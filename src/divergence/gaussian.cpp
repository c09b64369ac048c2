// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/gaussian.hpp"

namespace posemix {

POSEMIX_GAUSSIAN_DIVERGENCE(, SO3d);
POSEMIX_GAUSSIAN_DIVERGENCE(, SE3d);
POSEMIX_GAUSSIAN_DIVERGENCE(, PoseStackd);
POSEMIX_GAUSSIAN_DIVERGENCE(, Rnd<3>);

}  // namespace posemix
