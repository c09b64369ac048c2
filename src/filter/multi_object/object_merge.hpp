// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include "object_belief.hpp"

/// The merge of two hypotheses of one object.
namespace posemix::internal {

/// True when two poses differ by less than the bounds in angle and distance, up to a symmetry.
bool are_near(const SymmetryGroup& symmetries, const MergeBounds& bounds, const SE3d& a, SE3d b);

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
class RowsMidway {
 public:
  RowsMidway(const ConditionalPose& a, double log_weight_a, const ConditionalPose& b,
             double log_weight_b);

  /// Covariance of the merged object from those of the two, [xi_O; b].
  Matrix12d covariance(const Matrix12d& a, const Matrix12d& b) const;

  /// Cross-covariance of the merged object, 6 or 12 rows, from those of the two.
  template <class Rows>
  Rows cross_covariance(Rows a, Rows b) const {
    a.template topRows<6>() = (transport_a_ * a.template topRows<6>()).eval();
    b.template topRows<6>() = (transport_b_ * b.template topRows<6>()).eval();
    return share_a_ * a + share_b_ * b;
  }

  ConditionalPose merged(const ConditionalPose& a, const ConditionalPose& b) const;

 private:
  double share_a_;  ///< normalised weights
  double share_b_;
  Vector12d mean_a_;  ///< as seen from the midway point
  Vector12d mean_b_;
  SE3d pose_;
  Matrix6d transport_a_;  ///< J_l^-1, eq. 14
  Matrix6d transport_b_;
};

}  // namespace posemix::internal
