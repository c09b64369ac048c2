// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "camera_regression.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "posemix/filter/object_prior.hpp"
#include "posemix/filter/update.hpp"

namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// What is left of a reduction relative to the variance that is reduced, when it counts as
/// rounding.
constexpr double kRounding = 5e-15;

/// L with `before` - `after` = L L^T and few columns, by a Cholesky factorisation with pivots; none
/// where the difference is no such product.
std::optional<MatrixXd> low_rank_reduction(const MatrixXd& before, const MatrixXd& after) {
  MatrixXd rest = before - after;
  const Index most = std::min<Index>(kPoseDof, rest.rows() / 2);
  MatrixXd l(rest.rows(), most);
  const Eigen::VectorXd unit = before.diagonal().cwiseSqrt().cwiseInverse();
  for (Index k = 0; k < most; ++k) {
    Index pivot = 0;
    const double part = rest.diagonal().cwiseQuotient(before.diagonal()).maxCoeff(&pivot);
    if (part < kRounding) {
      l.conservativeResize(Eigen::NoChange, k);
      break;
    }
    l.col(k) = rest.col(pivot) / std::sqrt(rest(pivot, pivot));
    rest.noalias() -= l.col(k) * l.col(k).transpose();
  }
  const MatrixXd left = unit.asDiagonal() * rest * unit.asDiagonal();
  if (left.cwiseAbs().maxCoeff() > kRounding) return std::nullopt;
  return l;
}

/// Every six rows times the inverse of the factor of their block.
void whiten_rows(const std::vector<Cholesky6>& blocks, MatrixXd& m) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    auto own = m.middleRows<6>(offset(i));
    own = blocks[i].whitened_rows(own.transpose()).transpose().eval();
  }
}

/// A pose that turns by more than this has been taken beyond any rotation [rad].
constexpr double kMostTurn = 4.0;

/// The same for its variance, relative to that of a uniform rotation.
constexpr double kMostVariance = 4.0;

}  // namespace

RegularFactor::RegularFactor(const MatrixXd& covariance) {
  constexpr double kNearlySingular = 1e-13;
  constexpr double kLeastAdded = 1e-9;
  MatrixXd correlation = covariance;
  for (Index i = 0; i < covariance.rows(); i += kPoseDof) {
    blocks_.emplace_back(Matrix6d(covariance.block<6, 6>(i, i)));
    correlation.middleCols<6>(i) = blocks_.back().whitened_rows(correlation.middleCols<6>(i));
  }
  whiten_rows(blocks_, correlation);
  // What rounding leaves of the whitened blocks themselves.
  for (Index i = 0; i < covariance.rows(); i += kPoseDof)
    correlation.block<6, 6>(i, i).setIdentity();
  correlation_.compute(correlation);
  for (double next = kLeastAdded; next < 1.0; next *= 10.0) {
    if (correlation_.info() == Eigen::Success && correlation_.rcond() > kNearlySingular) return;
    added_ = next;
    correlation.diagonal().setConstant(1.0 + added_);
    correlation_.compute(correlation);
  }
}

MatrixXd RegularFactor::solve(const MatrixXd& columns) const {
  MatrixXd whitened = columns;
  whiten_rows(blocks_, whitened);
  MatrixXd solved = correlation_.solve(whitened);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    auto own = solved.middleRows<6>(offset(i));
    own = blocks_[i].after_whitening(own.transpose()).transpose().eval();
  }
  return solved;
}

void RegularFactor::add_to(MatrixXd& covariance) const {
  if (added_ == 0.0) return;
  for (Index i = 0; i < covariance.rows(); i += kPoseDof)
    covariance.block<6, 6>(i, i) *= 1.0 + added_;
}

bool is_rotation(const Vector6d& moved, const Matrix6d& covariance) {
  return moved.head<3>().norm() < kMostTurn &&
         covariance.diagonal().head<3>().maxCoeff() < kMostVariance * kUniformRotationVariance;
}

CameraRegression::CameraRegression(const CameraMoments& before, const CameraMoments& after)
    : before_(before), after_(after), camera_(before.covariance) {
  if (before.rig.empty()) return;
  shift_ = before.rig.factor().solve(after.rig.mean - before.rig.mean);
  if (auto l = low_rank_reduction(before.rig.covariance, after.rig.covariance)) {
    reduction_ = std::move(*l);
    // Eigen takes no matrix without columns: that of a detection by which nothing moves.
    if (reduction_.cols() > 0) solved_ = before.rig.factor().solve(reduction_);
  }
}

void CameraRegression::carry(ConditionalPose& pose) const {
  if (!before_.rig.empty()) {
    carry_with_rig(pose);
    return;
  }
  // G = P_OC P_CC^-1, O <- Exp(G (m' - m)) O, P_OO += G (P_CC' - P_CC) G^T, P_OC <- G P_CC'.
  if (!pose.slow) {
    const Matrix6d g = camera_.solved_rows(pose.cross_covariance.topRows<6>());
    const Vector6d shift = g * (after_.mean - before_.mean);
    Matrix6d own = pose.covariance.topLeftCorner<6, 6>();
    own += g * (after_.covariance - before_.covariance) * g.transpose();
    symmetrize(own);
    if (!is_rotation(shift, own)) {
      loosen(pose);
      return;
    }
    pose.pose = SE3d::exp(shift) * pose.pose;
    pose.covariance.topLeftCorner<6, 6>() = own;
    pose.cross_covariance.topRows<6>() = g * after_.covariance;
    return;
  }
  const Matrix12x6d g = camera_.solved_rows(pose.cross_covariance);
  const Vector12d shift = g * (after_.mean - before_.mean);
  Matrix12d own = pose.covariance;
  own += g * (after_.covariance - before_.covariance) * g.transpose();
  symmetrize(own);
  if (!is_rotation(shift.head<6>(), own.topLeftCorner<6, 6>())) {
    loosen(pose);
    return;
  }
  move(pose, shift);
  pose.covariance = own;
  pose.cross_covariance.noalias() = g * after_.covariance;
}

void CameraRegression::loosen(ConditionalPose& pose) const {
  const bool has_rig = !before_.rig.empty();
  const Index n = pose.slow ? 12 : 6;
  const MatrixXd before = has_rig ? before_.rig.covariance : MatrixXd(before_.covariance);
  const MatrixXd after = has_rig ? after_.rig.covariance : MatrixXd(after_.covariance);
  MatrixXd cross(n, before.cols());
  cross.leftCols<6>() = pose.cross_covariance.topRows(n);
  if (has_rig) cross.rightCols(cross.cols() - 6) = pose.extrinsics.topRows(n);
  cross = MatrixXd(before + after).llt().solve(cross.transpose()).transpose() * after;
  pose.cross_covariance.topRows(n) = cross.leftCols<6>();
  if (has_rig) pose.extrinsics.topRows(n) = cross.rightCols(cross.cols() - 6);
}

void CameraRegression::carry_with_rig(ConditionalPose& pose) const {
  // Without a slow error its rows are zero.
  const Index n = pose.slow ? 12 : 6;
  MatrixXd cross(n, before_.rig.covariance.cols());
  cross << pose.cross_covariance.topRows(n), pose.extrinsics.topRows(n);
  Vector12d shift = Vector12d::Zero();
  shift.head(n).noalias() = cross * shift_;
  MatrixXd own = pose.covariance.topLeftCorner(n, n);
  if (solved_.cols() > 0) {
    // With P' = P - L L^T, G (P' - P) G^T = -(G L) (G L)^T and G P' = P_OC - (G L) L^T.
    const MatrixXd gl = cross.lazyProduct(solved_);
    own -= gl.lazyProduct(gl.transpose());
    cross.noalias() -= gl * reduction_.transpose();
  } else {
    const MatrixXd g = before_.rig.factor().solve(cross.transpose()).transpose();
    own.noalias() += g * (after_.rig.covariance - before_.rig.covariance) * g.transpose();
    cross.noalias() = g * after_.rig.covariance;
  }
  symmetrize(own);
  if (!is_rotation(shift.head<6>(), own.topLeftCorner<6, 6>())) {
    loosen(pose);
    return;
  }
  move(pose, shift);
  pose.covariance.topLeftCorner(n, n) = own;
  pose.cross_covariance.topRows(n) = cross.leftCols<6>();
  pose.extrinsics.topRows(n) = cross.rightCols(cross.cols() - 6);
}

}  // namespace posemix::internal
