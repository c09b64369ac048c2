// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include "posemix/reduction/pair.hpp"

/// Costs of many pairs of Gaussians on SE(3) at once, with the widest vector instructions of the
/// machine. gaussian_symmetric_kl, runnalls_bound and distance are the reference.
namespace posemix::internal {

/// Numbers of a Gaussian: quaternion x y z w, translation, the lower triangle of the covariance by
/// columns, its log determinant, and the weight.
enum PoseField : std::size_t {
  kFieldPose = 0,
  kFieldCovariance = 7,
  kFieldLogDet = 28,
  kFieldWeight = 29,
  kPoseFields = 30
};

/// costs[i] of the pairs of a Gaussian, with the numbers `one`, and of `count` others, of which
/// columns + k * stride has field k. `stride` and `costs` have room for eight more.
void pair_costs(PairRule rule, DistanceMetric metric, const double* one, const double* columns,
                std::size_t stride, std::size_t count, double* costs);

}  // namespace posemix::internal
