// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <numeric>
#include <utility>

#include "joint_gaussian.hpp"

/// The base of the passive blocks, eq. (16) and (18) of docs/many-objects.md.
namespace posemix::internal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A slow error whose correlation with itself as it was is less is independent of everything.
constexpr double kForgotten = 1e-3;

}  // namespace

std::vector<Index> JointGaussian::carrier_coordinates() const {
  std::vector<Index> coordinates;
  for (const Carrier& carrier : carriers_) append_coordinates(coordinates, carrier.at);
  return coordinates;
}

MatrixXd JointGaussian::loadings(const std::vector<std::size_t>& order) const {
  MatrixXd u = MatrixXd::Zero(offset(order.size()), offset(carriers_.size()));
  for (std::size_t k = 0; k < carriers_.size(); ++k) {
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (!is_active(order[i])) block(u, i, k) = loading(blocks_[order[i]], carriers_[k]);
    }
  }
  return u;
}

/// s_i s_k (base_ik + U_i Cov(y) U_k^T), and the noise, eq. (16).
void JointGaussian::add_passive(const std::vector<std::size_t>& order, MatrixXd& lower) const {
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (is_active(order[k])) continue;
    for (std::size_t i = k; i < order.size(); ++i) {
      if (!is_active(order[i]))
        block(lower, i, k) = base(blocks_[order[i]].row, blocks_[order[k]].row);
    }
  }
  const std::vector<Index> y = carrier_coordinates();
  const MatrixXd u = loadings(order);
  const MatrixXd left = u * MatrixXd(covariance_(y, y));
  lower.triangularView<Eigen::Lower>() += left * u.transpose();
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Block& slow = blocks_[order[k]];
    if (slow.at >= 0 || !slow.slow) continue;
    lower.block(offset(k), offset(k), lower.rows() - offset(k), 6) *= slow.scale;
    lower.block(offset(k), 0, 6, offset(k + 1)) *= slow.scale;
    block(lower, k, k) += slow.noise;
  }
}

void JointGaussian::add_active(const std::vector<std::size_t>& order, MatrixXd& lower) const {
  const std::vector<Index> y = carrier_coordinates();
  const MatrixXd u = loadings(order);
  for (std::size_t a = 0; a < order.size(); ++a) {
    if (!is_active(order[a])) continue;
    const Index at = first(order[a]);
    SixColumns column = u * MatrixXd(covariance_(y, Eigen::seqN(at, 6)));
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (is_active(order[i])) {
        rows(column, i) = covariance_.block<6, 6>(first(order[i]), at);
      } else {
        rows(column, i) *= blocks_[order[i]].scale;
      }
    }
    const Index after = lower.rows() - offset(a);
    lower.block(offset(a), offset(a), after, 6) = column.bottomRows(after);
    lower.block(offset(a), 0, 6, offset(a)) = column.topRows(offset(a)).transpose();
  }
}

MatrixXd JointGaussian::lower(const std::vector<std::size_t>& order) const {
  if (carriers_.empty()) return covariance_;  // nothing is passive, and `order` is all
  MatrixXd result = MatrixXd::Zero(offset(order.size()), offset(order.size()));
  add_passive(order, result);
  add_active(order, result);
  return result;
}

MatrixXd JointGaussian::covariance() const {
  if (carriers_.empty()) return covariance_;
  std::vector<std::size_t> order(size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const MatrixXd half = lower(order);
  return half.selfadjointView<Eigen::Lower>();
}

std::vector<PoseMoments> JointGaussian::pose_moments() const {
  std::vector<PoseMoments> result(size());
  std::vector<std::size_t> passive;
  for (std::size_t i = 0; i < size(); ++i) {
    if (is_active(i)) {
      result[i] = {covariance(i, i), covariance(i, kCamera)};
    } else if (is_pose(i)) {
      passive.push_back(i);
    }
  }
  if (passive.empty()) return result;
  const std::vector<Index> y = carrier_coordinates();
  const MatrixXd u = loadings(passive);
  const MatrixXd cross = u * MatrixXd(covariance_(y, Eigen::seqN(0, 6)));
  // U Psi U^T is the sum of a half and its transpose.
  MatrixXd psi = covariance_(y, y);
  psi.diagonal() *= 0.5;
  const MatrixXd left = u * psi.triangularView<Eigen::Lower>();
  for (std::size_t k = 0; k < passive.size(); ++k) {
    const Matrix6d half = rows(left, k) * rows(u, k).transpose();
    const Index row = blocks_[passive[k]].row;
    result[passive[k]] = {base(row, row) + half + half.transpose(), rows(cross, k)};
  }
  return result;
}

void JointGaussian::activate_all() {
  covariance_ = covariance();
  carriers_.clear();
  base_.reset();
  for (std::size_t i = 0; i < size(); ++i) blocks_[i].at = offset(i);
}

void JointGaussian::free_slow(Block& slow, const Matrix6d& covariance) {
  slow.at = slow.row = -1;
  slow.scale = 0.0;
  slow.noise = covariance;
}

void JointGaussian::rebase(const std::vector<bool>& keeps) {
  std::vector<std::size_t> order;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < size(); ++i) {
    Block& block = blocks_[i];
    if (!keeps[i] && block.slow && block.at < 0 && block.correlation < kForgotten) {
      free_slow(block, covariance(i, i));
      continue;
    }
    if (keeps[i] || i <= extrinsics_ || block.is_motion) kept.push_back(order.size());
    order.push_back(i);
  }
  base_ = std::make_shared<const MatrixXd>(lower(order));
  for (std::size_t i = 0; i < order.size(); ++i) {
    Block& block = blocks_[order[i]];
    block.at = -1;
    block.row = offset(i);
    block.scale = 1.0;
    block.noise.setZero();
  }
  // What is active depends on its carriers by one.
  const Index n = offset(kept.size());
  covariance_ = MatrixXd::Zero(2 * n + 6, 2 * n + 6);
  carriers_ = {{.at = 2 * n, .row = -1, .columns = nullptr}};
  for (std::size_t i = 0; i < kept.size(); ++i) {
    Block& block = blocks_[order[kept[i]]];
    block.at = offset(i);
    block.row = -1;
    const Index row = offset(kept[i]);
    carriers_.push_back({.at = n + offset(i),
                         .row = row,
                         .columns = std::make_shared<const SixColumns>(base_columns(row))});
    for (std::size_t k = 0; k < kept.size(); ++k)
      covariance_.block<6, 6>(offset(i), offset(k)) = base(row, offset(kept[k]));
  }
  covariance_.block(n, 0, n, n).setIdentity();
  covariance_.block(0, n, n, n).setIdentity();
}

/// Eq. (18): the regression on the common blocks is as `first` has it.
void JointGaussian::take_carriers(const JointGaussian& first, const Coordinates& coordinates,
                                  const VectorXd& apart) {
  const auto& [kept, common, common_there] = coordinates;
  const MatrixXd before = first.covariance_(common_there, common_there);
  const Index n = static_cast<Index>(kept.size());
  const Index m = static_cast<Index>(offset(first.carriers_.size()));
  MatrixXd by = MatrixXd::Zero(m, static_cast<Index>(common.size()));
  for (std::size_t k = 0; k < first.carriers_.size(); ++k) {
    by.middleRows<6>(offset(k)) =
        first.covariance_(Eigen::seqN(first.carriers_[k].at, 6), common_there);
  }
  by = before.llt().solve(by.transpose()).transpose().eval();
  MatrixXd next = MatrixXd::Zero(n + m, n + m);
  next.topLeftCorner(n, n) = covariance_(kept, kept);
  next.bottomLeftCorner(m, n) = by * covariance_(common, kept);
  next.topRightCorner(n, m) = next.bottomLeftCorner(m, n).transpose();
  next.bottomRightCorner(m, m) =
      by * (MatrixXd(covariance_(common, common)) - before) * by.transpose();
  symmetrize(next);
  covariance_ = std::move(next);
  base_ = first.base_;
  carriers_ = first.carriers_;
  const VectorXd mean = by * apart;
  for (std::size_t k = 0; k < carriers_.size(); ++k) {
    carriers_[k].at = n + offset(k);
    carriers_[k].mean = mean.segment<6>(offset(k));
  }
}

void JointGaussian::rebase_like(const JointGaussian& first, const BlockPairs& same) {
  std::vector<std::optional<std::size_t>> there(size());
  for (const auto& [own, others] : same) there[own] = others;
  Coordinates coordinates;
  std::vector<std::pair<std::size_t, Matrix6d>> freed;
  for (std::size_t i = 0; i < size(); ++i) {
    const bool keep = !there[i] || first.is_active(*there[i]);
    if (keep && is_pose(i)) activate(i);
    if (!keep && first.blocks_[*there[i]].row < 0) freed.emplace_back(i, covariance(i, i));
  }
  for (std::size_t i = 0; i < size(); ++i) {
    if (there[i] && !first.is_active(*there[i])) continue;
    append_coordinates(coordinates.kept, blocks_[i].at);
    if (!there[i]) continue;
    append_coordinates(coordinates.common, blocks_[i].at);
    append_coordinates(coordinates.common_there, first.blocks_[*there[i]].at);
  }
  BlockPairs active;
  for (const auto& pair : same) {
    if (first.is_active(pair.second)) active.push_back(pair);
  }
  std::sort(active.begin(), active.end());
  const VectorXd apart = -difference(first, active);
  take_carriers(first, coordinates, apart);
  Index at = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    Block& block = blocks_[i];
    const bool keep = !there[i] || first.is_active(*there[i]);
    block.row = keep ? -1 : first.blocks_[*there[i]].row;
    block.scale = 1.0;
    block.noise.setZero();
    block.at = keep ? std::exchange(at, at + kPoseDof) : -1;
  }
  for (const auto& [i, covariance] : freed) free_slow(blocks_[i], covariance);
}

}  // namespace posemix::internal
