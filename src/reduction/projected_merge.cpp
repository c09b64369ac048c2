// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/rotation_of.hpp"
#include "posemix/reduction/merge.hpp"

namespace posemix {
namespace {

/// The density with u = 0 as its mean, which it is already up to rounding.
template <RotationOrPose G>
ProjectedGaussian<G> centred(const ProjectedGaussian<G>& density) {
  typename G::Tangent mean = density.tangent_mean();
  mean.template head<3>().setZero();
  return ProjectedGaussian<G>::trusted(density.tangent_point(), mean, density.covariance());
}

}  // namespace

template <RotationOrPose G>
MergeResult<ProjectedGaussian<G>> merge(
    std::span<const Component<ProjectedGaussian<G>>* const> components,
    const MergeSettings& settings) {
  using Density = ProjectedGaussian<G>;
  require(!components.empty(), "merge: there is no component");
  const internal::Carrying<Density> carrying(components);
  if (components.size() == 1) return {*components.front(), true};
  const double log_weight = carrying.log_total;
  if (carrying.size() == 1) return {{log_weight, *carrying.densities.front()}, true};

  std::vector<Component<Density>> parts;
  std::vector<SO3d> modes;
  for (std::size_t i = 0; i < carrying.size(); ++i) {
    parts.push_back({std::log(carrying.weights[i]), *carrying.densities[i]});
    modes.push_back(rotation_of(carrying.densities[i]->mean()));
  }
  const std::span<const Component<Density>> all(parts);
  switch (settings.rule) {
    case MergeRule::midway: {
      const MeanResult<SO3d> point =
          gnomonic_mean(modes, carrying.weights, {settings.max_iterations, settings.tolerance});
      return {{log_weight, centred(tangent_moments<G>(all, point.mean))}, point.converged};
    }
    case MergeRule::tangent_of_larger:
      return {
          {log_weight, change_chart_to_mode(tangent_moments<G>(all, modes[carrying.heaviest()]))},
          true};
    case MergeRule::moment_matched: {
      Moments<Density> matched = moments<G>(all, {settings.max_iterations, settings.tolerance});
      return {{log_weight, std::move(matched.density)}, matched.converged};
    }
  }
  throw InvalidInput("merge: unknown rule");
}

template <RotationOrPose G>
MergeResult<ProjectedGaussian<G>> merge(std::span<const Component<ProjectedGaussian<G>>> components,
                                        const MergeSettings& settings) {
  return merge<G>(
      std::span<const Component<ProjectedGaussian<G>>* const>(internal::pointers_to(components)),
      settings);
}

template MergeResult<ProjectedGaussian<SO3d>> merge(
    std::span<const Component<ProjectedGaussian<SO3d>>* const>, const MergeSettings&);
template MergeResult<ProjectedGaussian<SO3d>> merge(
    std::span<const Component<ProjectedGaussian<SO3d>>>, const MergeSettings&);
template MergeResult<ProjectedGaussian<SE3d>> merge(
    std::span<const Component<ProjectedGaussian<SE3d>>* const>, const MergeSettings&);
template MergeResult<ProjectedGaussian<SE3d>> merge(
    std::span<const Component<ProjectedGaussian<SE3d>>>, const MergeSettings&);

}  // namespace posemix
