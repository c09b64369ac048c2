// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <tuple>
#include <vector>

#include "density/state_fields.hpp"
#include "joint_gaussian.hpp"

namespace posemix::internal {

template <>
struct StateFields<JointGaussian::Block> {
  static JointGaussian::Block blank() { return {}; }
  static auto tie(auto& x) {
    auto& [pose, slow, at, is_motion, row, scale, correlation, noise] = x;
    return std::tie(pose, slow, at, is_motion, row, scale, correlation, noise);
  }
};

template <>
struct StateFields<JointGaussian::Carrier> {
  static JointGaussian::Carrier blank() { return {}; }
  static auto tie(auto& x) {
    auto& [at, row, columns, mean] = x;
    return std::tie(at, row, columns, mean);
  }
};

template <>
struct StateFields<JointGaussian> {
  static JointGaussian blank() {
    return JointGaussian(ConcentratedGaussian<SE3d>(SE3d(), Matrix6d::Identity()));
  }
  static auto tie(auto& x) {
    auto& [blocks, extrinsics, covariance, carriers, base, linearised_at] = x;
    return std::tie(blocks, extrinsics, covariance, carriers, base, linearised_at);
  }
  static void validate(const JointGaussian& x) {
    const auto& covariance = x.covariance_;
    const auto& base = x.base_;
    require_state(x.extrinsics_ < x.blocks_.size() && !x.blocks_.front().is_motion,
                  "a camera, and the poses of cameras on it");
    require_state(!x.linearised_at_ || x.extrinsics_ > 0,
                  "cameras on the body, where one has seen");
    // That of the carriers alone is none: it may have negative variances.
    require_state(covariance.rows() == covariance.cols() && covariance.allFinite(),
                  "a covariance that is finite");
    require_state(!base || (base->rows() == base->cols() && base->allFinite()), "a base");
    std::vector<bool> taken(static_cast<std::size_t>(covariance.rows()), false);
    require_blocks(x, taken);
    for (const auto& carrier : x.carriers_) {
      take(carrier.at, taken);
      require_row(x, carrier.row);
      require_state(!carrier.columns || (base && carrier.columns->rows() == base->rows() &&
                                         carrier.columns->allFinite()),
                    "carriers with a column for every row of the base");
      require_state(carrier.mean.allFinite(), "carriers with a mean that is finite");
    }
    for (const bool one : taken) require_state(one, "a block for every coordinate");
    require_state(could_be_covariance(x.covariance()),
                  "a covariance that is positive semi-definite");
  }

 private:
  static void require_blocks(const JointGaussian& x, std::vector<bool>& taken) {
    for (std::size_t i = 0; i < x.blocks_.size(); ++i) {
      const auto& block = x.blocks_[i];
      require_state(i > x.extrinsics_ || (!block.slow && block.at == offset(i)),
                    "the camera and its rig first");
      require_state(block.at >= -1 && (block.at >= 0 || block.row >= 0 || block.slow),
                    "a pose that is active or in the base");
      if (block.at >= 0) take(block.at, taken);
      require_row(x, block.row);
      require_state((!block.slow || block.slow->allFinite()) && block.noise.allFinite() &&
                        std::isfinite(block.scale) && std::isfinite(block.correlation),
                    "blocks that are finite");
    }
  }
  /// The coordinates from `at` on are those of one block.
  static void take(Eigen::Index at, std::vector<bool>& taken) {
    require_state(at >= 0 && at <= static_cast<Eigen::Index>(taken.size()) - kPoseDof,
                  "a coordinate that there is");
    for (Eigen::Index k = at; k < at + kPoseDof; ++k) {
      require_state(!taken[static_cast<std::size_t>(k)], "coordinates of one block each");
      taken[static_cast<std::size_t>(k)] = true;
    }
  }
  static void require_row(const JointGaussian& x, Eigen::Index row) {
    require_state(row == -1 || (x.base_ && row >= 0 && row <= x.base_->rows() - kPoseDof),
                  "a row of the base");
  }
};

}  // namespace posemix::internal
