// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include "camera_regression.hpp"
#include "joint_gaussian.hpp"

/// The mixture of two joint Gaussians, eq. (11) of docs/many-objects.md.
namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The coordinates that are not in `s`.
std::vector<Index> rest_of(const std::vector<Index>& s, Index size) {
  std::vector<bool> is_in(static_cast<std::size_t>(size), false);
  for (const Index i : s) is_in[static_cast<std::size_t>(i)] = true;
  std::vector<Index> rest;
  for (Index i = 0; i < size; ++i) {
    if (!is_in[static_cast<std::size_t>(i)]) rest.push_back(i);
  }
  return rest;
}

/// x <- J x for the coordinates x of the block that begins at `first`.
void transport(const Matrix6d& jacobian, Index first, MatrixXd& covariance) {
  covariance.middleRows<6>(first) = (jacobian * covariance.middleRows<6>(first)).eval();
  covariance.middleCols<6>(first) = (covariance.middleCols<6>(first) * jacobian.transpose()).eval();
}

}  // namespace

VectorXd JointGaussian::difference(const JointGaussian& other, const BlockPairs& shared) const {
  VectorXd result(offset(shared.size()));
  for (std::size_t i = 0; i < shared.size(); ++i) {
    const auto [here, there] = shared[i];
    result.segment<kPoseDof>(offset(i)) = is_pose(here)
                                              ? (other.pose(there) * pose(here).inverse()).log()
                                              : Vector6d(other.slow(there) - slow(here));
  }
  return result;
}

VectorXd JointGaussian::mix(double weight, const JointGaussian& given, const BlockPairs& shared) {
  if (!base_ && !given.base_) return mix_aligned(weight, given, shared);
  JointGaussian other = given;
  align(other, shared);
  BlockPairs active;
  for (const auto& [here, there] : shared) {
    if (is_active(here)) {
      active.emplace_back(here, there);
      continue;
    }
    Block& block = blocks_[here];
    const Block& apart = other.blocks_[there];
    if (block.slow) {
      *block.slow += weight * (*apart.slow - *block.slow);
    } else {
      block.pose = SE3d::exp(weight * (apart.pose * block.pose.inverse()).log()) * block.pose;
    }
  }
  return mix_aligned(weight, other, active);
}

VectorXd JointGaussian::mix_aligned(double weight, const JointGaussian& other,
                                    const BlockPairs& shared) {
  std::vector<Index> s;  // the coordinates that are shared, here and there
  std::vector<Index> t;
  for (const auto& [here, there] : shared) {
    append_coordinates(s, first(here));
    append_coordinates(t, other.first(there));
  }
  const auto own = static_cast<Index>(s.size());
  VectorXd apart = difference(other, shared);
  apart.conservativeResize(own + offset(carriers_.size()));
  for (const Carrier& carrier : carriers_) {
    const Carrier& there = *other.carrier_of(carrier.row);
    apart.segment<6>(static_cast<Index>(s.size())) = there.mean - carrier.mean;
    append_coordinates(s, carrier.at);
    append_coordinates(t, there.at);
  }
  MatrixXd b = other.covariance_(t, t);
  // As seen from the mean of the mixture, eq. 14 of the midway-merge paper.
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (!is_pose(shared[i].first)) continue;
    const Vector6d d = apart.segment<kPoseDof>(offset(i));
    transport(SE3d::left_jacobian_inverse(-weight * d), first(shared[i].first), covariance_);
    transport(SE3d::left_jacobian_inverse((1.0 - weight) * d), offset(i), b);
  }
  MatrixXd mixed = (1.0 - weight) * covariance_(s, s) + weight * b;
  mixed.noalias() += weight * (1.0 - weight) * apart * apart.transpose();
  const VectorXd mean = regressed_on(s, weight * apart, mixed, own);
  for (Carrier& carrier : carriers_) carrier.mean += mean.segment<6>(carrier.at);
  move_active(mean);
  return mean.head(rig_dof());
}

VectorXd JointGaussian::regressed_on(const std::vector<Index>& s, const VectorXd& mean_s,
                                     const MatrixXd& covariance_s, Index own) {
  // x_r = G x_t + e for the rest r and the first `own` coordinates t of s.
  const std::vector<Index> t(s.begin(), s.begin() + own);
  const MatrixXd before = covariance_(t, t);
  const std::vector<Index> r = rest_of(s, covariance_.rows());
  VectorXd mean = VectorXd::Zero(covariance_.rows());
  mean(s) = mean_s;
  if (!r.empty()) {
    const MatrixXd after = covariance_s.topLeftCorner(own, own);
    const RegularFactor regular(before);
    MatrixXd g = regular.solve(covariance_(t, r)).transpose();
    MatrixXd own_block = covariance_(r, r) + g * (after - before) * g.transpose();
    mean(r) = g * mean_s.head(own);
    if (!are_rotations(mean, own_block, r)) {
      // As CameraRegression::loosen.
      g = MatrixXd(before + after).llt().solve(covariance_(t, r)).transpose();
      own_block = covariance_(r, r);
      mean(r).setZero();
    }
    const MatrixXd rows = g * covariance_s.topRows(own);
    covariance_(r, s) = rows;
    covariance_(s, r) = rows.transpose();
    covariance_(r, r) = own_block;
    regular.add_to(covariance_);
  }
  covariance_(s, s) = covariance_s;
  symmetrize(covariance_);
  return mean;
}

/// is_rotation of the poses among the coordinates `r`.
bool JointGaussian::are_rotations(const VectorXd& moved, const MatrixXd& covariance,
                                  const std::vector<Index>& r) const {
  for (const Block& block : blocks_) {
    const auto at = std::find(r.begin(), r.end(), block.at);
    if (at == r.end() || block.slow || block.is_motion) continue;
    const auto i = static_cast<Index>(at - r.begin());
    if (!is_rotation(moved.segment<6>(block.at), covariance.block<6, 6>(i, i))) return false;
  }
  return true;
}

/// A carrier that is missing is one that does not vary. Without a common base all blocks are made
/// active.
void JointGaussian::align(JointGaussian& other, const BlockPairs& shared) {
  if (base_ != other.base_) {
    activate_all();
    other.activate_all();
    return;
  }
  std::vector<bool> is_shared(size(), false);
  for (const auto& [here, there] : shared) {
    is_shared[here] = true;
    if (is_active(here) == other.is_active(there) || !is_pose(here)) continue;
    activate(here);
    other.activate(there);
  }
  for (std::size_t i = 0; i < size(); ++i) {
    if (!is_shared[i] && is_pose(i)) activate(i);
  }
  for (const Carrier& carrier : std::vector<Carrier>(carriers_)) other.add_carrier(carrier);
  for (const Carrier& carrier : other.carriers_) add_carrier(carrier);
}

void JointGaussian::add_carrier(const Carrier& like) {
  if (carrier_of(like.row)) return;
  const Index n = covariance_.rows();
  covariance_.conservativeResize(n + kPoseDof, n + kPoseDof);
  covariance_.bottomRows<6>().setZero();
  covariance_.rightCols<6>().setZero();
  carriers_.push_back({.at = n, .row = like.row, .columns = like.columns});
}

const JointGaussian::Carrier* JointGaussian::carrier_of(Index row) const {
  for (const Carrier& carrier : carriers_) {
    if (carrier.row == row) return &carrier;
  }
  return nullptr;
}

}  // namespace posemix::internal
