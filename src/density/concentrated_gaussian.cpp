// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/density/concentrated_gaussian.hpp"

namespace posemix {

template class ConcentratedGaussian<SO3d>;
template class ConcentratedGaussian<SE3d>;
template class ConcentratedGaussian<PoseStackd>;
template class ConcentratedGaussian<Rnd<3>>;

}  // namespace posemix
