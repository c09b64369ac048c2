// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <utility>

#include "joint_gaussian.hpp"

/// The passive blocks of the joint Gaussian, eq. (15) to (18) of docs/many-objects.md.
namespace posemix::internal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::size_t JointGaussian::active() const {
  return static_cast<std::size_t>(
      std::count_if(blocks_.begin(), blocks_.end(), [](const Block& b) { return b.at >= 0; }));
}

double JointGaussian::rotation_variance(std::size_t index) const {
  const Block& block = blocks_[index];
  const Index at = block.at < 0 ? block.row : block.at;
  return (block.at < 0 ? *base_ : covariance_).diagonal().segment<3>(at).maxCoeff();
}

Matrix6d JointGaussian::loading(const Block& block, const Carrier& carrier) const {
  if (carrier.columns && block.row >= 0) return carrier.columns->middleRows<6>(block.row);
  if (block.slow) return Matrix6d::Zero();
  return Matrix6d::Identity();
}

Matrix6d JointGaussian::base(Index row, Index column) const {
  if (row < 0 || column < 0) return Matrix6d::Zero();
  if (row > column) return base_->block<6, 6>(row, column);
  if (row < column) return base_->block<6, 6>(column, row).transpose();
  return Matrix6d(base_->block<6, 6>(row, row).selfadjointView<Eigen::Lower>());
}

SixColumns JointGaussian::base_columns(Index row) const {
  const Index n = base_->rows();
  SixColumns columns(n, 6);
  columns.topRows(row) = base_->block(row, 0, 6, row).transpose();
  columns.middleRows<6>(row) = base(row, row);
  columns.bottomRows(n - row - 6) = base_->block(row + 6, row, n - row - 6, 6);
  return columns;
}

/// s U Cov(y, .), eq. (16).
MatrixXd JointGaussian::passive_rows(const Block& block) const {
  MatrixXd result = MatrixXd::Zero(6, covariance_.rows());
  for (const Carrier& carrier : carriers_) {
    if (block.slow && (!carrier.columns || block.row < 0)) continue;
    result.noalias() += loading(block, carrier) * covariance_.middleRows<6>(carrier.at);
  }
  return block.scale * result;
}

/// Eq. (16) for a passive block and any other.
Matrix6d JointGaussian::passive_block(const Block& row, const Block& column) const {
  if (column.at >= 0) {
    Matrix6d result = Matrix6d::Zero();
    for (const Carrier& carrier : carriers_)
      result += loading(row, carrier) * covariance_.block<6, 6>(carrier.at, column.at);
    return row.scale * result;
  }
  return passive_pair(row, passive_rows(row), column);
}

Matrix6d JointGaussian::passive_pair(const Block& row, const MatrixXd& row_covariance,
                                     const Block& column) const {
  Matrix6d result = column.scale * row.scale * base(row.row, column.row);
  for (const Carrier& carrier : carriers_) {
    result.noalias() += column.scale * row_covariance.middleCols<6>(carrier.at) *
                        loading(column, carrier).transpose();
  }
  if (&row == &column) result += row.noise;
  return result;
}

/// The columns of the base at the object become carriers, on which the object itself depends by
/// its scale alone.
void JointGaussian::activate(std::size_t index) {
  if (is_active(index)) return;
  const std::size_t blocks = blocks_of(index);
  const Index n = covariance_.rows();
  const Index d = offset(blocks);
  MatrixXd own(d, n);
  Matrix12d self = Matrix12d::Zero();
  for (std::size_t i = 0; i < blocks; ++i) {
    const Block& given = blocks_[index + i];
    const MatrixXd all = passive_rows(given);
    for (std::size_t k = 0; k < blocks; ++k)
      block(self, i, k) = passive_pair(given, all, blocks_[index + k]);
    rows(own, i) = all;
  }
  symmetrize(self);
  const auto with_base = static_cast<std::size_t>(
      std::count_if(blocks_.begin() + static_cast<std::ptrdiff_t>(index),
                    blocks_.begin() + static_cast<std::ptrdiff_t>(index + blocks),
                    [](const Block& one) { return one.row >= 0; }));
  const Index grown = d + offset(with_base);
  covariance_.conservativeResize(n + grown, n + grown);
  covariance_.rightCols(grown).setZero();
  covariance_.bottomRows(grown).setZero();
  covariance_.block(n, 0, d, n) = own;
  covariance_.block(0, n, n, d) = own.transpose();
  covariance_.block(n, n, d, d) = self.topLeftCorner(d, d);
  Index next = n + d;
  for (std::size_t i = 0; i < blocks; ++i) {
    Block& one = blocks_[index + i];
    one.at = n + offset(i);
    one.correlation = 1.0;
    const Index row = std::exchange(one.row, -1);
    if (row < 0) continue;
    covariance_.block<6, 6>(next, one.at) = one.scale * Matrix6d::Identity();
    covariance_.block<6, 6>(one.at, next) = one.scale * Matrix6d::Identity();
    carriers_.push_back(
        {.at = next, .row = row, .columns = std::make_shared<const SixColumns>(base_columns(row))});
    next += kPoseDof;
  }
}

void JointGaussian::move_passive(const VectorXd& mean) {
  if (carriers_.empty()) return;
  VectorXd moved = VectorXd::Zero(base_->rows());
  Vector6d shift = Vector6d::Zero();
  for (Carrier& carrier : carriers_) {
    const Vector6d part = mean.segment<6>(carrier.at);
    carrier.mean += part;
    if (carrier.columns) {
      moved.noalias() += *carrier.columns * part;
    } else {
      shift = part;
    }
  }
  for (Block& block : blocks_) {
    if (block.at >= 0) continue;
    if (block.row < 0) continue;
    const Vector6d by = moved.segment<6>(block.row);
    if (block.slow) {
      *block.slow += block.scale * by;
    } else {
      block.pose = SE3d::exp(by + shift) * block.pose;
    }
  }
}

}  // namespace posemix::internal
