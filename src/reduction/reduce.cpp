// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/reduce.hpp"

namespace posemix {

template Reduction<ConcentratedGaussian<SO3d>> reduce(Mixture<ConcentratedGaussian<SO3d>>,
                                                      const ReductionSettings&);
template Reduction<ConcentratedGaussian<SE3d>> reduce(Mixture<ConcentratedGaussian<SE3d>>,
                                                      const ReductionSettings&);
template Reduction<ConcentratedGaussian<PoseStackd>> reduce(
    Mixture<ConcentratedGaussian<PoseStackd>>, const ReductionSettings&);
template Reduction<ProjectedGaussian<SO3d>> reduce(Mixture<ProjectedGaussian<SO3d>>,
                                                   const ReductionSettings&);
template Reduction<ProjectedGaussian<SE3d>> reduce(Mixture<ProjectedGaussian<SE3d>>,
                                                   const ReductionSettings&);

}  // namespace posemix
