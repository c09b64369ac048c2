// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "back_projection.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "posemix/lie/pose_blocks.hpp"

namespace posemix::internal {
namespace {

using Eigen::MatrixXd;

/// A pose and its parent, which is the pose itself where it has no parent.
struct Link {
  std::size_t pose;
  std::size_t parent;
  TwistMatrix<double> reset{Eigen::Matrix3d::Identity(),
                            Eigen::Matrix3d::Zero()};  ///< M_k, or J_l(xi_k) without a parent

  bool has_parent() const { return parent != pose; }
};

/// All poses, parents before children.
std::vector<Link> links(std::size_t poses, std::span<const Detection> detections,
                        std::size_t first_object) {
  const std::size_t anchor = detections.front().object;
  std::vector<Link> result;
  result.reserve(poses);
  result.push_back({anchor, anchor});
  result.push_back({kCamera, anchor});
  for (std::size_t k = kCamera + 1; k < poses; ++k) {
    if (k == anchor) continue;
    const bool seen =
        std::any_of(detections.begin(), detections.end(),
                    [&](const Detection& detection) { return detection.object == k; });
    result.push_back({k, k < first_object ? k : seen ? kCamera : anchor});
  }
  return result;
}

/// Moves one pose, whose parent has been moved, and finds the reset of its perturbation.
void move(const PoseStackd& mean, const Eigen::VectorXd& xi, Link& link, PoseStackd& moved) {
  const SE3d& before = mean[link.pose];
  const Vector6d xi_k = segment(xi, link.pose);
  if (!link.has_parent()) {
    moved[link.pose] = SE3d::exp(xi_k) * before;
    link.reset = SE3d::left_jacobian_blocks(xi_k);
    return;
  }
  const SE3d to_parent = mean[link.parent].inverse();
  const TwistMatrix<double> adjoint = to_parent.adjoint_blocks();
  const Vector6d zeta = adjoint.times(Vector6d(xi_k - segment(xi, link.parent)));
  const SE3d& parent = moved[link.parent];
  moved[link.pose] = parent * SE3d::exp(zeta) * (to_parent * before);
  link.reset = parent.adjoint_blocks() * SE3d::left_jacobian_blocks(zeta) * adjoint;
}

/// The rows of L P: from every child its parent's rows are subtracted, then the child is reset, and
/// the parent's new rows are added.
void reset_rows(const std::vector<Link>& links, MatrixXd& p) {
  std::for_each(links.rbegin(), links.rend(), [&p](const Link& link) {
    if (link.has_parent()) rows(p, link.pose) -= rows(p, link.parent);
  });
  const auto poses = links.size();
  for (const Link& link : links) {
    for (std::size_t column = 0; column < poses; ++column) {
      block(p, link.pose, column) = link.reset.times(Matrix6d(block(p, link.pose, column)));
    }
    if (link.has_parent()) rows(p, link.pose) += rows(p, link.parent);
  }
}

}  // namespace

Hypothesis back_project_relative(const PoseStackd& mean, const Eigen::VectorXd& xi,
                                 MatrixXd covariance, std::span<const Detection> detections,
                                 std::size_t first_object) {
  std::vector<Link> chain = links(mean.size(), detections, first_object);
  PoseStackd moved = mean;
  for (Link& link : chain) move(mean, xi, link, moved);
  // L P L^T: first the rows, then the columns as the rows of the transpose.
  reset_rows(chain, covariance);
  covariance.transposeInPlace();
  reset_rows(chain, covariance);
  symmetrize(covariance);
  return Hypothesis::trusted(std::move(moved), std::move(covariance));
}

}  // namespace posemix::internal
