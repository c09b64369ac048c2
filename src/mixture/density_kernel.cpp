// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/density_kernel.hpp"

namespace posemix::internal {
namespace {

/// L^-1 with P = L L^T, row by row, and the log of the Gaussian's density at its mean.
template <class Covariance>
struct Whitening {
  Covariance factor;
  double log_at_mean;

  explicit Whitening(const Covariance& covariance) {
    const Eigen::LLT<Covariance> cholesky(covariance);
    factor = cholesky.matrixL().solve(Covariance::Identity());
    log_at_mean = -0.5 * (log_det(cholesky) + static_cast<double>(covariance.rows()) * kLogTwoPi);
  }
  Covariance precision() const { return factor.transpose() * factor; }
};

/// The first rows of a matrix.
template <class Matrix, std::size_t N>
void put_rows(const Matrix& matrix, std::array<std::array<double, 6>, N>& rows) {
  for (Eigen::Index i = 0; i < matrix.rows() && i < static_cast<Eigen::Index>(N); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = matrix(i, j);
  }
}

void put(const SO3d& rotation, std::array<double, 4>& q) {
  Eigen::Vector4d::Map(q.data()) = rotation.quaternion().coeffs();
}

template <RotationOrPose G>
ProjectedKernel projected_kernel(const ProjectedGaussian<G>& density) {
  const Whitening whitening(density.covariance());
  ProjectedKernel kernel{};
  kernel.dimensions = static_cast<std::size_t>(G::Dof);
  put(density.tangent_point(), kernel.tangent_point);
  Eigen::Vector3d::Map(kernel.u.data()) = density.tangent_mean().template head<3>();
  if constexpr (G::Dof == 6)
    Eigen::Vector3d::Map(kernel.translation.data()) = density.tangent_mean().template tail<3>();
  put_rows(whitening.factor, kernel.factor);
  put_rows(whitening.precision(), kernel.precision_u);
  kernel.log_constant =
      whitening.log_at_mean - density.log_normalizer() - gnomonic::kLogHaarPerHalfSphere;
  return kernel;
}

}  // namespace

RotationKernel kernel_of(const ConcentratedGaussian<SO3d>& density) {
  const Whitening whitening(density.covariance());
  RotationKernel kernel{};
  put(density.mean(), kernel.rotation);
  put_rows(whitening.factor, kernel.factor);
  kernel.log_constant = whitening.log_at_mean;
  return kernel;
}

PoseKernel kernel_of(const ConcentratedGaussian<SE3d>& density) {
  const Whitening whitening(density.covariance());
  PoseKernel kernel{};
  put(density.mean().rotation(), kernel.rotation);
  Eigen::Vector3d::Map(kernel.translation.data()) = density.mean().translation();
  put_rows(whitening.factor, kernel.factor);
  put_rows(whitening.precision(), kernel.precision);
  kernel.log_constant = whitening.log_at_mean;
  return kernel;
}

ProjectedKernel kernel_of(const ProjectedGaussian<SO3d>& density) {
  return projected_kernel(density);
}
ProjectedKernel kernel_of(const ProjectedGaussian<SE3d>& density) {
  return projected_kernel(density);
}

}  // namespace posemix::internal
