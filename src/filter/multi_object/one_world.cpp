// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "one_world.hpp"

#include <optional>
#include <vector>

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

/// Covariance of the pose `i` as seen from the camera.
Matrix6d seen_covariance(const JointGaussian& joint, std::size_t i) {
  const Matrix6d cross = joint.covariance(i, kCamera);
  return joint.covariance(i, i) + joint.covariance(kCamera, kCamera) - cross - cross.transpose();
}

/// The leading hypotheses of an object in two states, as poses of their joint Gaussians.
struct LeadingPair {
  std::size_t j;
  std::size_t a;
  std::size_t b;
};

/// None where an object has a leading hypothesis in one state alone, or where two are not near, as
/// seen from the camera; `there` takes the world of `b` to that of `a`.
std::optional<KeptVector<LeadingPair>> near_pairs(const MultiObjectState& a,
                                                  const MultiObjectState& b, const SE3d& there) {
  KeptVector<LeadingPair> pairs;
  for (std::size_t j = 0; j < a.objects.size(); ++j) {
    const auto x = a.objects[j].belief.pose_index();
    const auto y = b.objects[j].belief.pose_index();
    if (x.has_value() != y.has_value()) return std::nullopt;
    if (!x) continue;
    if (!are_near(a.objects[j].sensor().symmetries, a.merge_bounds, a.joint.pose(*x),
                  there * b.joint.pose(*y)))
      return std::nullopt;
    pairs.push_back({j, *x, *y});
  }
  return pairs;
}

/// Whether two leading hypotheses agree as seen from the camera.
bool are_seen_alike(const MultiObjectState& a, const MultiObjectState& b, const SE3d& there,
                    const LeadingPair& pair) {
  const SymmetryGroup& symmetries = a.objects[pair.j].sensor().symmetries;
  const SE3d& led = a.joint.pose(pair.a);
  SE3d other = there * b.joint.pose(pair.b);
  if (!symmetries.is_trivial()) other = symmetries.closest(other, led, Matrix6d::Identity());
  const Matrix6d mean = 0.5 * (seen_covariance(a.joint, pair.a) +
                               there.adjoint_congruence(seen_covariance(b.joint, pair.b)));
  return are_within(a.merge_bounds, mean, led, other);
}

/// Whether the poses of a block that is on the body agree.
bool are_alike(const MultiObjectState& a, std::size_t i, const MultiObjectState& b, std::size_t k) {
  return are_within(a.merge_bounds, 0.5 * (a.joint.covariance(i, i) + b.joint.covariance(k, k)),
                    a.joint.pose(i), b.joint.pose(k));
}

}  // namespace

bool are_one_but_for_the_world(const MultiObjectState& a, const MultiObjectState& b) {
  if (a.has_known_objects || a.camera_given_at) return false;
  const SE3d there = a.joint.pose(kCamera) * b.joint.pose(kCamera).inverse();
  const auto pairs = near_pairs(a, b, there);
  if (!pairs) return false;
  for (const LeadingPair& pair : *pairs)
    if (!are_seen_alike(a, b, there, pair)) return false;
  for (std::size_t e = 0; e < a.joint.extrinsics(); ++e) {
    const std::size_t i = JointGaussian::extrinsic_block(e);
    if (!are_alike(a, i, b, i)) return false;
  }
  return !a.motion || are_alike(a, *a.motion, b, *b.motion);
}

bool are_at_one_place(const MultiObjectState& a, const MultiObjectState& b) {
  return are_within(a.merge_bounds,
                    0.5 * (a.reported_camera().covariance() + b.reported_camera().covariance()),
                    a.joint.pose(kCamera), b.joint.pose(kCamera));
}

}  // namespace posemix::internal
