// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "placed_object.hpp"

/// One step of a smoother backward in time, for one Gaussian (docs/moving-objects.md, "Looking
/// ahead").
namespace posemix::internal {

/// Rauch, Tung and Striebel, eq. (19): `before` given what `smoothed` knows of the state after it,
/// which was `predicted` from `before` by the Jacobian `f`. Rows of the state whose factor `gain`
/// is zero are only considered: their mean and variance stay.
PlacedObject smoothed_before(const PlacedObject& before, const Matrix18d& f,
                             const PlacedObject& predicted, const PlacedObject& smoothed,
                             const Vector18d& gain);

/// What turns one Gaussian into another: the evidence of later observations about a state, as the
/// factor exp(eta^T y - y^T Pi y / 2) in coordinates y in which the first Gaussian is the standard
/// normal one and Pi is diagonal, eq. (20).
class LaterEvidence {
 public:
  LaterEvidence(const PlacedObject& without, const PlacedObject& with);

  struct Result {
    PlacedObject object;
    double log_likelihood;  ///< of the later observations, up to a constant
  };
  /// Eq. (21) and (22): the Gaussian `source`, which is `converted` in the state of the two
  /// Gaussians by the Jacobian `f`, with this evidence.
  Result applied_to(const PlacedObject& source, const PlacedObject& converted, const Matrix18d& f,
                    const Vector18d& gain) const;

 private:
  PlacedObject without_;
  Eigen::MatrixXd to_y_;      ///< y = to_y (x - x_without)
  Eigen::VectorXd eta_;       ///< of y
  Eigen::VectorXd pi_;        ///< not negative
  Eigen::VectorXd rest_;      ///< of the move of the mean, what the factor does not tell
  Eigen::VectorXd widening_;  ///< variance that the second Gaussian has more than the first
};

}  // namespace posemix::internal
