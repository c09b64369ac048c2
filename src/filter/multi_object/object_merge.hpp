// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include "object_belief.hpp"

/// The merge of two hypotheses of one object.
namespace posemix::internal {

/// True when two hypotheses agree within the bounds, seen from a camera with covariance `camera`.
/// `b` becomes the equivalent pose, under the symmetries, that is nearest to `a`.
bool agree(const Matrix6d& camera, const SymmetryGroup& symmetries, const MergeBounds& bounds,
           const ConditionalPose& a, ConditionalPose& b);

/// Weight and history of the merge of two hypotheses.
Standing merged(const Standing& a, const Standing& b);

/// Midway-merge paper, eq. 12 to 19, for the object's rows of two joint Gaussians.
///
/// This is the rule of posemix/reduction/merge.hpp. It is written for rows here, because the camera
/// and the other objects are common to both hypotheses and are not moved.
class Midway {
 public:
  Midway(const ConditionalPose& a, double log_weight_a, const ConditionalPose& b,
         double log_weight_b);

  const SE3d& pose() const { return pose_; }

  /// Covariance of the merged pose from those of the two.
  Matrix6d covariance(const Matrix6d& a, const Matrix6d& b) const;

  /// Cross-covariance of the merged pose, six rows, from those of the two.
  template <class Rows>
  Rows cross_covariance(const Rows& a, const Rows& b) const {
    return share_a_ * transport_a_ * a + share_b_ * transport_b_ * b;
  }

  ConditionalPose merged(const ConditionalPose& a, const ConditionalPose& b) const {
    return {pose_, covariance(a.covariance, b.covariance),
            cross_covariance(a.cross_covariance, b.cross_covariance)};
  }

 private:
  double share_a_;  ///< normalised weights
  double share_b_;
  Vector6d mean_a_;  ///< as seen from the midway point
  Vector6d mean_b_;
  SE3d pose_;
  Matrix6d transport_a_;  ///< J_l^-1, eq. 14
  Matrix6d transport_b_;
};

}  // namespace posemix::internal
