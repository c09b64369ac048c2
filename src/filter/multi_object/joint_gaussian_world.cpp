// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include "base/dense_kernels.hpp"
#include "joint_gaussian.hpp"

/// What a shift of the world does to the joint Gaussian: eq. (10) and (31) of
/// docs/many-objects.md.
namespace posemix::internal {

using Eigen::Index;

std::optional<Matrix6d> JointGaussian::world_information(const WorldMoves& moved) const {
  if (active() < size()) return std::nullopt;
  KeptMatrix<> factor(covariance_.rows(), covariance_.rows());
  auto b = factor.get();
  b = covariance_;
  if (!factor_in_place(b)) return std::nullopt;
  KeptMatrix<> product(kPoseDof, b.rows());
  auto whitened = product.get();  // N^T L^-T
  for (std::size_t i = 0; i < size(); ++i) whitened.middleCols<6>(first(i)) = moved[i].transpose();
  solve_transposed_from_right(b, whitened);
  return Matrix6d(whitened * whitened.transpose());
}

void JointGaussian::take_out(const Matrix6d& d, const WorldMoves& moved) {
  KeptMatrix<6> n(covariance_.rows());
  KeptMatrix<6> n_d(covariance_.rows());
  for (std::size_t i = 0; i < size(); ++i) n.get().middleRows<6>(first(i)) = moved[i];
  n_d.get().noalias() = n.get() * d;
  subtract_symmetric_product(covariance_, n_d.get(), n.get());
}

KeptVector<Index> JointGaussian::world_coordinates() const {
  KeptVector<Index> coordinates;
  for (std::size_t i = 0; i < size(); ++i)
    if (is_in_world(i) && is_active(i)) coordinates.push_back(first(i));
  for (const Carrier& carrier : carriers_)
    if (!carrier.columns) coordinates.push_back(carrier.at);
  return coordinates;
}

void JointGaussian::add_world_error(const Matrix6d& shift) {
  const KeptVector<Index> poses = world_coordinates();
  for (const Index i : poses) {
    for (const Index k : poses) covariance_.block<6, 6>(i, k) += shift;
  }
}

/// Poses get the shift of the world, with the carrier of shifts.
void JointGaussian::shift_back(const CameraChange& change, const Matrix6d& back) {
  const SE3d shift = SE3d::exp(-back * change.mean);
  const Matrix6d added = back * change.covariance * back.transpose();
  for (std::size_t i = 0; i < size(); ++i)
    if (is_in_world(i)) blocks_[i].pose = shift * blocks_[i].pose;
  for (Carrier& carrier : carriers_)
    if (!carrier.columns) carrier.mean -= back * change.mean;
  const KeptVector<Index> poses = world_coordinates();
  KeptMatrix<6> product(covariance_.rows());
  auto with_error = product.get();
  with_error.noalias() = change.error_covariance.get() * back.transpose();
  for (Index i = 0; i < covariance_.rows(); i += kPoseDof) {
    const Matrix6d own = with_error.middleRows<6>(i);
    const bool is_pose = std::find(poses.begin(), poses.end(), i) != poses.end();
    for (const Index k : poses) {
      covariance_.block<6, 6>(i, k) += own;
      covariance_.block<6, 6>(k, i) += own.transpose();
      if (is_pose) covariance_.block<6, 6>(i, k) += added;
    }
  }
  symmetrize(covariance_);
}

}  // namespace posemix::internal
