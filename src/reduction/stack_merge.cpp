// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <utility>
#include <vector>

#include "base/kept_matrices.hpp"
#include "lie/pose_kernels.hpp"
#include "lie/stack_kernels.hpp"
#include "posemix/reduction/merge.hpp"

namespace posemix::internal {
namespace {

/// Memory for the poses of a merge, which a thread keeps.
struct Workspace {
  std::vector<TwistMatrix<double>> first;
  std::vector<TwistMatrix<double>> second;
  Eigen::MatrixXd distance;

  void resize(std::size_t poses) {
    first.resize(poses);
    second.resize(poses);
    distance.resize(6 * static_cast<Eigen::Index>(poses), 1);
  }
};

MutableRows rows_of(std::vector<TwistMatrix<double>>& blocks) {
  return {blocks.data()->a.data(), 18};
}

}  // namespace

/// Either rule is a sum of two congruences and of w_1 w_2 d d^T, d the distance in the tangent
/// space.
ConcentratedGaussian<PoseStackd> merged_pair(MergeRule rule, double w_1, double w_2,
                                             const ConcentratedGaussian<PoseStackd>& first,
                                             const ConcentratedGaussian<PoseStackd>& second) {
  const std::size_t poses = first.mean().size();
  static thread_local Workspace work;
  work.resize(poses);
  PoseStackd mean(poses);
  const MergedPoses found{internal::rows_of(&mean[0]),
                          rows_of(work.first),
                          rows_of(work.second),
                          {work.distance.data(), 6}};
  const ConstPoseRows x_1 = internal::rows_of(first.mean().poses().data());
  const ConstPoseRows x_2 = internal::rows_of(second.mean().poses().data());
  if (rule == MergeRule::midway) {
    midway_of(x_1, x_2, {w_1, w_2}, found, poses);
  } else {
    tangent_merge_of(x_1, x_2, {w_1, w_2}, found, poses);
  }
  work.distance *= std::sqrt(w_1 * w_2);
  const Congruence parts[] = {{work.first.data(), &first.covariance(), w_1},
                              {work.second.data(), &second.covariance(), w_2}};
  Eigen::MatrixXd covariance = kept_matrix(work.distance.rows());
  sum_congruences(parts, work.distance, covariance);
  return ConcentratedGaussian<PoseStackd>::trusted(std::move(mean), std::move(covariance));
}

void reuse(ConcentratedGaussian<PoseStackd>&& density) {
  keep(std::move(density).release().second);
}

}  // namespace posemix::internal
