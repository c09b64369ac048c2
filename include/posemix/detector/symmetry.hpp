// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/base/units.hpp"
#include "posemix/lie/lie.hpp"

/// Objects that look the same after a motion of their own frame.
namespace posemix {

/// A line about which the object may be turned by any angle and looks the same.
struct SymmetryAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< object frame, any length but zero
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< on the axis, object frame [m]
};

/// The variance of the angle about an axis of symmetry, where one pose stands for all equivalent
/// ones, as a part of the variance of a uniform angle.
inline constexpr double kFixedAngle = 3e-7;

/// Tolerances within which two motions count as the same one when a group is built: the rotation
/// between them, and the distance of their translations. They allow for rounded numbers in files.
struct SymmetryTolerance {
  double rotation_rad = radians(0.5);
  double translation_m = 1e-3;
};

/// The motions g of an object's frame after which it looks the same: poses X and X g are equivalent
/// (Hodan et al., "BOP Challenge 2020", section 2.2: a discrete set times continuous rotations).
///
/// Invariants, to the tolerance:
/// - the set of all e k, e one of elements() and k a rotation about axes(), is closed under
///   composition and inversion;
/// - elements() begins with the identity, and no two of them differ by a rotation about axes();
/// - axes() is empty, one axis (its point nearest to the origin), or, for all rotations about a
///   point, the three coordinate directions through that point; directions have length one.
class SymmetryGroup {
 public:
  /// The identity alone.
  SymmetryGroup() : SymmetryGroup(std::vector<SE3d>{}) {}

  /// The group of `elements` times the rotations about `axes`. The identity may be missing, and
  /// duplicates are dropped. Axes in several directions through one point stand for all rotations
  /// about it.
  /// @throws InvalidInput naming two elements whose product is missing, an element that moves an
  /// axis, or two axes without a common point; and for numbers that are not finite
  explicit SymmetryGroup(const std::vector<SE3d>& elements,
                         const std::vector<SymmetryAxis>& axes = {},
                         const SymmetryTolerance& tolerance = {});

  /// The group that had these elements() and axes(), which are kept as they are: a group that was
  /// made with a wide tolerance is not closed to a narrower one.
  /// @throws InvalidInput without elements, where the first is not the identity, and for numbers
  /// that are not finite
  static SymmetryGroup from_stored(std::vector<SE3d> elements,
                                   const std::vector<SymmetryAxis>& axes);

  /// The rotations about an axis through the object's origin by multiples of a turn / fold; for
  /// fold 0 by any angle.
  /// @throws InvalidInput for a negative fold, one whose steps the default tolerance takes for the
  /// same motion, and an axis that is zero or not finite
  static SymmetryGroup turns(const Eigen::Vector3d& axis, int fold);

  const std::vector<SE3d>& elements() const { return elements_; }
  const std::vector<SymmetryAxis>& axes() const { return axes_; }
  bool is_trivial() const { return elements_.size() == 1 && axes_.empty(); }

  /// The equivalent pose X g with the least z^T information z, z = Log((X g)^-1 reference), along
  /// the object's own axes.
  ///
  /// The search over elements() is exact. The angle about an axis starts from the one that leaves
  /// the least rotation, phi = 2 atan2(q_v . d, q_w), and is improved by Gauss-Newton steps while
  /// they lower the cost: it is the best angle where an equivalent pose is near the reference, and
  /// may be a local optimum elsewhere.
  SE3d closest(const SE3d& pose, const SE3d& reference, const Matrix6d& information) const;

  /// The same over the equivalent poses whose error (X g)^-1 reference has no rotation about the
  /// axes: its quaternion has q_v . d = 0. That is the one to ask how far an error is from nothing,
  /// with the inverse of a covariance that has unobserved_covariance(): of closest() a wrong pose
  /// would be nearer, because in Log a turn by a large angle turns a translation, too, from an axis
  /// along which the information is much into one along which it is little.
  SE3d closest_observed(const SE3d& pose, const SE3d& reference, const Matrix6d& information) const;

  /// The equivalent pose X g whose rotation is nearest to that of the reference. Several rotations
  /// are equally near where a group about one axis has the reference turned by half a step.
  SE3d nearest_rotation(const SE3d& pose, const SE3d& reference) const;

  /// The error T_truth^-1 T_estimate against the equivalent truth that leaves the least rotation:
  /// g error with a motion g of the group.
  SE3d reduced_error(const SE3d& error) const;

  /// The covariance of the part of the pose that no detection observes, along the object's own axes
  /// (of n in X Exp(n)): (pi / sqrt 3)^2 a a^T for each axis, the variance of a uniform angle, with
  /// a = [d; p x d] for the direction d through the point p. Zero without axes.
  Matrix6d unobserved_covariance() const;

  /// The projection I - sum_a a [d; 0]^T, along the object's own axes, that takes the rotations
  /// about axes() out of a tangent vector. The identity without axes.
  Matrix6d observed_projection() const;

 private:
  template <class>
  friend struct internal::StateFields;

  /// Directions of the tangent space along which the pose is free: one column per axis.
  using Generators = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, 3>;
  struct Named;
  /// The group is that of the rotations by multiples of `step_rad` about an axis through the
  /// origin.
  struct Turns {
    Eigen::Vector3d axis;
    double step_rad;
  };

  void take_axes(const std::vector<SymmetryAxis>& axes, const SymmetryTolerance& tolerance);
  void require_axes_kept(const std::vector<Named>& all, const SymmetryTolerance& tolerance) const;
  void require_closed(const std::vector<Named>& all, const SymmetryTolerance& tolerance) const;
  /// The motion g of the group for which the angle of `rotation` g is least.
  SE3d undoing(const SO3d& rotation) const;
  /// The rotation k about axes() that leaves the least rotation in k^-1 error.
  SE3d turned_to(const SE3d& error) const;
  template <class Refine>
  SE3d best_motion(const SE3d& pose, const SE3d& reference, const Matrix6d& information,
                   const Refine& refined) const;
  bool are_same(const SE3d& a, const SE3d& b, const SymmetryTolerance& tolerance) const;

  std::vector<SE3d> elements_;
  std::vector<SE3d> inverses_;
  std::vector<SymmetryAxis> axes_;
  std::optional<Turns> turns_;  ///< where turns() made the group: the nearest turn without a search
  Generators generators_{6, 0};
};

}  // namespace posemix
