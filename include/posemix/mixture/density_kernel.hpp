// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/projected_gaussian.hpp"
#include "posemix/mixture/em_kernels.hpp"

/// Densities as the inner loops of em_kernels.hpp take them, one name for all kinds: EM and
/// log_densities() are templates over it.
namespace posemix::internal {

RotationKernel kernel_of(const ConcentratedGaussian<SO3d>& density);
PoseKernel kernel_of(const ConcentratedGaussian<SE3d>& density);
ProjectedKernel kernel_of(const ProjectedGaussian<SO3d>& density);
ProjectedKernel kernel_of(const ProjectedGaussian<SE3d>& density);

/// N may be Eigen::Dynamic.
template <int N>
RnKernel kernel_of(const ConcentratedGaussian<Rnd<N>>& density) {
  using Covariance = typename Rnd<N>::TangentMatrix;
  const Eigen::Index n = density.dof();
  const Eigen::LLT<Covariance> factor(density.covariance());
  const Covariance whitening = factor.matrixL().solve(Covariance::Identity(n, n));
  RnKernel kernel;
  const auto& mean = density.mean().value();
  kernel.mean.assign(mean.begin(), mean.end());
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) kernel.factor.push_back(whitening(i, j));
  }
  kernel.log_constant = -0.5 * (log_det(factor) + static_cast<double>(n) * kLogTwoPi);
  return kernel;
}

/// Densities for which there are inner loops: all but those of several poses.
template <class D>
concept HasKernel = requires(const D& density) {
  kernel_of(density);
};

/// The log densities of a block of elements; `scratch` has kPoseRows rows.
inline void log_density_of(const RotationKernel& density, const EmRow* samples, std::size_t count,
                           EmRow* /*scratch*/, EmRow& out) {
  rotation_log_density(samples, count, density, out);
}
inline void log_density_of(const PoseKernel& density, const EmRow* samples, std::size_t count,
                           EmRow* scratch, EmRow& out) {
  pose_log_density(samples, count, density, scratch, out);
}
inline void log_density_of(const ProjectedKernel& density, const EmRow* samples, std::size_t count,
                           EmRow* scratch, EmRow& out) {
  projected_log_density(samples, count, density, scratch, out);
}
inline void log_density_of(const RnKernel& density, const EmRow* samples, std::size_t count,
                           EmRow* /*scratch*/, EmRow& out) {
  rn_log_density(samples, count, density, out);
}

}  // namespace posemix::internal
