// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "one_world.hpp"

#include "object_merge.hpp"

namespace posemix::internal {
namespace {

/// Whether two poses agree within the bounds of a merge, `mean` being the mean of their covariances
/// about axes of the world.
bool are_within(const MergeBounds& bounds, const Matrix6d& mean, const SE3d& a, const SE3d& b) {
  const Cholesky6 factor(mean);
  return factor.ok() &&
         factor.whitened((b * a.inverse()).log()).squaredNorm() < bounds.squared_distance;
}

/// Covariance of the leading hypothesis of object `j` as seen from the camera.
Matrix6d seen_covariance(const MultiObjectState& state, std::size_t j) {
  const ObjectBelief& belief = state.objects[j].belief;
  const ConditionalPose led = belief.pose(state.joint, *belief.leading());
  const Matrix6d cross = led.cross_covariance.topRows<6>();
  return led.covariance.topLeftCorner<6, 6>() + state.joint.covariance(kCamera, kCamera) - cross -
         cross.transpose();
}

/// Whether the leading hypotheses of object `j` agree as seen from the camera, where `there` takes
/// the world of `b` to that of `a`; also where neither state has one.
bool is_seen_alike(const MultiObjectState& a, const MultiObjectState& b, const SE3d& there,
                   std::size_t j) {
  const ObjectBelief& x = a.objects[j].belief;
  const ObjectBelief& y = b.objects[j].belief;
  if (x.leading().has_value() != y.leading().has_value()) return false;
  if (!x.leading()) return true;
  const SymmetryGroup& symmetries = a.objects[j].sensor().symmetries;
  const SE3d led = x.pose(a.joint, *x.leading()).pose;
  SE3d other = there * y.pose(b.joint, *y.leading()).pose;
  if (!are_near(symmetries, a.merge_bounds, led, other)) return false;
  if (!symmetries.is_trivial()) other = symmetries.closest(other, led, Matrix6d::Identity());
  const Matrix6d mean =
      0.5 * (seen_covariance(a, j) + there.adjoint_congruence(seen_covariance(b, j)));
  return are_within(a.merge_bounds, mean, led, other);
}

/// Whether the poses of a block that is on the body agree.
bool are_alike(const MultiObjectState& a, std::size_t i, const MultiObjectState& b, std::size_t k) {
  return are_within(a.merge_bounds, 0.5 * (a.joint.covariance(i, i) + b.joint.covariance(k, k)),
                    a.joint.pose(i), b.joint.pose(k));
}

}  // namespace

bool are_one_but_for_the_world(const MultiObjectState& a, const MultiObjectState& b) {
  if (a.has_known_objects || a.has_given_camera) return false;
  const SE3d there = a.joint.pose(kCamera) * b.joint.pose(kCamera).inverse();
  for (std::size_t j = 0; j < a.objects.size(); ++j)
    if (!is_seen_alike(a, b, there, j)) return false;
  for (std::size_t e = 0; e < a.joint.extrinsics(); ++e) {
    const std::size_t i = JointGaussian::extrinsic_block(e);
    if (!are_alike(a, i, b, i)) return false;
  }
  return !a.motion || are_alike(a, *a.motion, b, *b.motion);
}

bool are_at_one_place(const MultiObjectState& a, const MultiObjectState& b) {
  return are_alike(a, kCamera, b, kCamera);
}

}  // namespace posemix::internal
