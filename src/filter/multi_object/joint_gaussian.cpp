// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "joint_gaussian.hpp"

#include <algorithm>

#include "base/cholesky6.hpp"

namespace posemix::internal {

using Eigen::Index;
using Eigen::MatrixXd;

void move(ConditionalPose& object, const Vector12d& by) {
  object.pose = SE3d::exp(by.head<6>()) * object.pose;
  if (object.slow) *object.slow += by.tail<6>();
}

Matrix12x6d regression_on_camera(const Matrix12x6d& cross_covariance, const Matrix6d& camera) {
  return Cholesky6(camera).solved_rows(cross_covariance);
}

Matrix6d JointGaussian::covariance(std::size_t row, std::size_t column) const {
  const Block& a = blocks_[row];
  const Block& b = blocks_[column];
  if (a.at >= 0 && b.at >= 0) return covariance_.block<6, 6>(a.at, b.at);
  if (a.at < 0 && b.at < 0) return passive_block(a, b);
  return a.at < 0 ? passive_block(a, b) : Matrix6d(passive_block(b, a).transpose());
}

ConditionalPose JointGaussian::conditional(std::size_t index) const {
  ConditionalPose object{pose(index), {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  const std::size_t blocks = blocks_of(index);
  if (blocks > 1) object.slow = blocks_[index + 1].slow;
  if (extrinsics_ > 0) object.extrinsics.setZero(12, rig_dof() - kPoseDof);
  for (std::size_t i = 0; i < blocks; ++i) {
    for (std::size_t e = 0; e < extrinsics_; ++e) {
      object.extrinsics.block<6, 6>(offset(i), offset(e)) =
          covariance(index + i, extrinsic_block(e));
    }
  }
  if (is_active(index)) {
    const Index n = dof(index);
    object.covariance.topLeftCorner(n, n) = covariance_.block(first(index), first(index), n, n);
    object.cross_covariance.topRows(n) = covariance_.block(first(index), 0, n, kPoseDof);
    return object;
  }
  for (std::size_t i = 0; i < blocks; ++i) {
    block(object.cross_covariance, i, 0) = covariance(index + i, kCamera);
    for (std::size_t k = 0; k < blocks; ++k)
      block(object.covariance, i, k) = covariance(index + i, index + k);
  }
  symmetrize(object.covariance);
  return object;
}

MatrixXd JointGaussian::rows_of(std::size_t index) {
  activate(index);
  return covariance_.middleRows(first(index), dof(index));
}

/// B_j. = P_OC P_CC^-1 B_C.
KeptMatrix<> JointGaussian::regressed_rows(const ConditionalPose& object) const {
  const Index n = object.slow ? 12 : 6;
  KeptMatrix<> result(n, covariance_.cols());
  if (extrinsics_ > 0) {
    result.get().noalias() =
        regression_on_rig(object, rig()).topRows(n) * covariance_.topRows(rig_dof());
  } else {
    const Matrix12x6d g =
        regression_on_camera(object.cross_covariance, covariance(kCamera, kCamera));
    result.get().noalias() = g.topRows(n) * rows(covariance_, kCamera);
  }
  return result;
}

std::size_t JointGaussian::append(const ConditionalPose& object) {
  const std::size_t index = size();
  const std::size_t blocks = object.slow ? 2 : 1;
  const Index before = covariance_.rows();
  blocks_.push_back({.pose = object.pose, .at = before});
  if (object.slow) blocks_.push_back({.pose = {}, .slow = object.slow, .at = before + kPoseDof});
  const Index n = before + offset(blocks);
  covariance_.conservativeResize(n, n);
  covariance_.bottomRows(offset(blocks)).setZero();
  covariance_.rightCols(offset(blocks)).topRows(before).setZero();
  replace(index, object);
  return index;
}

void JointGaussian::release_camera(const Matrix6d& covariance) {
  covariance_.topRows<kPoseDof>().setZero();
  covariance_.leftCols<kPoseDof>().setZero();
  covariance_.topLeftCorner<kPoseDof, kPoseDof>() = covariance;
}

std::size_t JointGaussian::append_motion(const SE3d& motion, const Matrix6d& covariance) {
  ConditionalPose alone{motion, {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  alone.covariance.topLeftCorner<6, 6>() = covariance;
  const std::size_t index = append(alone);
  blocks_[index].is_motion = true;
  return index;
}

void JointGaussian::replace(std::size_t index, const ConditionalPose& object) {
  activate(index);
  KeptMatrix<> regressed = regressed_rows(object);
  auto own = regressed.get();
  own.leftCols(kPoseDof) = object.cross_covariance.topRows(dof(index));
  own.middleCols(kPoseDof, object.extrinsics.cols()) = object.extrinsics.topRows(dof(index));
  set_rows(index, object.pose, object.slow, own, object.covariance);
}

void JointGaussian::erase(std::size_t index) {
  const Index n = dof(index);
  if (is_active(index)) {
    const Index at = first(index);
    std::vector<Index> kept;
    for (Index i = 0; i < covariance_.rows(); ++i) {
      if (i < at || i >= at + n) kept.push_back(i);
    }
    covariance_ = MatrixXd(covariance_(kept, kept));
    for (Block& other : blocks_) other.at -= other.at > at ? n : 0;
    for (Carrier& other : carriers_) other.at -= other.at > at ? n : 0;
  }
  const auto begin = blocks_.begin() + static_cast<std::ptrdiff_t>(index);
  blocks_.erase(begin, begin + static_cast<std::ptrdiff_t>(blocks_of(index)));
}

void JointGaussian::set_rows(std::size_t index, const SE3d& pose,
                             const std::optional<Vector6d>& slow,
                             const Eigen::Ref<const MatrixXd>& values, const Matrix12d& own) {
  const Index n = dof(index);
  const Index at = first(index);
  blocks_[index].pose = pose;
  if (slow) blocks_[index + 1].slow = slow;
  covariance_.middleCols(at, n) = values.transpose();
  covariance_.middleRows(at, n) = values;
  covariance_.block(at, at, n, n) = own.topLeftCorner(n, n);
}

void JointGaussian::transform(std::size_t index, const Eigen::Ref<const MatrixXd>& f) {
  activate(index);
  auto own_rows = covariance_.middleRows(first(index), dof(index));
  KeptMatrix<> new_rows(dof(index), covariance_.cols());
  new_rows.get().noalias() = f * own_rows;
  own_rows = new_rows.get();
  auto own_columns = covariance_.middleCols(first(index), dof(index));
  KeptMatrix<> new_columns(covariance_.rows(), dof(index));
  new_columns.get().noalias() = own_columns * f.transpose();
  own_columns = new_columns.get();
  symmetrize(covariance_);
}

void JointGaussian::move_object(std::size_t index, const Vector12d& by) {
  blocks_[index].pose = SE3d::exp(by.head<6>()) * blocks_[index].pose;
  if (blocks_of(index) > 1) *blocks_[index + 1].slow += by.tail<6>();
}

void JointGaussian::decay_slow(std::size_t index, double factor, const Matrix6d& q) {
  Block& slow = blocks_[index + 1];
  *slow.slow *= factor;
  if (slow.at < 0) {
    slow.scale *= factor;
    slow.correlation *= factor;
    slow.noise = factor * factor * slow.noise + q;
    return;
  }
  covariance_.middleRows<6>(slow.at) *= factor;
  covariance_.middleCols<6>(slow.at) *= factor;
  covariance_.block<6, 6>(slow.at, slow.at) += q;
}

void JointGaussian::add_noise(std::size_t index, const Matrix6d& q) {
  activate(index);
  covariance_.block<6, 6>(first(index), first(index)) += q;
}

void JointGaussian::combine(const BlockCoordinates& given) {
  const Index at = first(given.block);
  const Index beside = first(given.beside);
  KeptMatrix<6> kept_columns(covariance_.rows());
  auto columns = kept_columns.get();
  columns.noalias() = covariance_.middleCols<6>(at) * given.own.transpose();
  columns.noalias() += covariance_.middleCols<6>(beside) * given.other.transpose();
  covariance_.middleCols<6>(at) = columns;
  KeptMatrix<> kept_rows(kPoseDof, covariance_.cols());
  auto rows = kept_rows.get();
  rows.noalias() = given.own * covariance_.middleRows<6>(at);
  rows.noalias() += given.other * covariance_.middleRows<6>(beside);
  covariance_.middleRows<6>(at) = rows;
  symmetrize(covariance_);
}

Vector6d JointGaussian::move_active(const Eigen::VectorXd& mean) {
  for (Block& block : blocks_) {
    if (block.at < 0) continue;
    const Vector6d part = mean.segment<kPoseDof>(block.at);
    if (block.slow) {
      *block.slow += part;
    } else {
      block.pose = SE3d::exp(part) * block.pose;
    }
  }
  return mean.head<kPoseDof>();
}

}  // namespace posemix::internal
