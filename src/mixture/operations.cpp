// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/operations.hpp"

namespace posemix {
namespace {

/// Applies `part`, which takes a joint density to one of a pose, to every component.
template <class Part>
Mixture<ConcentratedGaussian<SE3d>> of_every_component(
    const Mixture<ConcentratedGaussian<PoseStackd>>& joint, const Part& part) {
  std::vector<Component<ConcentratedGaussian<SE3d>>> parts;
  parts.reserve(joint.size());
  for (const auto& component : joint.components()) {
    parts.push_back({component.log_weight, part(component.density)});
  }
  return Mixture<ConcentratedGaussian<SE3d>>(std::move(parts));
}

}  // namespace

template class Mixture<ConcentratedGaussian<SO3d>>;
template class Mixture<ConcentratedGaussian<SE3d>>;
template class Mixture<ConcentratedGaussian<PoseStackd>>;

Mixture<ConcentratedGaussian<SE3d>> marginal(const Mixture<ConcentratedGaussian<PoseStackd>>& joint,
                                             std::size_t index) {
  return of_every_component(joint, [&](const auto& density) { return marginal(density, index); });
}

Mixture<ConcentratedGaussian<SE3d>> relative_pose(
    const Mixture<ConcentratedGaussian<PoseStackd>>& joint, std::size_t from, std::size_t to) {
  return of_every_component(joint,
                            [&](const auto& density) { return relative_pose(density, from, to); });
}

}  // namespace posemix
