// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/symmetry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "posemix/base/error.hpp"

namespace posemix {

/// An element and what messages call it.
struct SymmetryGroup::Named {
  SE3d motion;
  std::string name;
};

namespace {

constexpr int kMostSteps = 4;
constexpr double kSmallestGain = 1e-6;  ///< of the cost, below which no step is made

std::string described(const SE3d& motion) {
  const Eigen::AngleAxisd turn(motion.rotation().quaternion());
  const Eigen::Vector3d& axis = turn.axis();
  const Eigen::Vector3d mm = 1e3 * motion.translation();
  return fmt::format("{:.1f} deg about [{:.3g}, {:.3g}, {:.3g}] with [{:.3g}, {:.3g}, {:.3g}] mm",
                     degrees(turn.angle()), axis.x(), axis.y(), axis.z(), mm.x(), mm.y(), mm.z());
}

std::string described(const SymmetryTolerance& tolerance) {
  return fmt::format("{:.3g} deg and {:.3g} mm", degrees(tolerance.rotation_rad),
                     1e3 * tolerance.translation_m);
}

/// The direction with length one, and the point of the axis nearest to the origin.
SymmetryAxis canonical(const SymmetryAxis& axis, std::size_t index) {
  const double length = axis.direction.norm();
  if (!(length > 0.0) || !std::isfinite(length) || !axis.point.allFinite()) {
    throw InvalidInput(fmt::format(
        "symmetries: axis {} has direction [{}, {}, {}] and point [{}, {}, {}], expected finite "
        "numbers and a direction that is not zero",
        index, axis.direction.x(), axis.direction.y(), axis.direction.z(), axis.point.x(),
        axis.point.y(), axis.point.z()));
  }
  const Eigen::Vector3d d = axis.direction / length;
  return {d, axis.point - d.dot(axis.point) * d};
}

bool are_parallel(const SymmetryAxis& a, const SymmetryAxis& b, double tolerance_rad) {
  return a.direction.cross(b.direction).norm() <= std::sin(tolerance_rad);
}

/// Distance of a point from an axis [m].
double distance(const SymmetryAxis& axis, const Eigen::Vector3d& point) {
  return axis.direction.cross(point - axis.point).norm();
}

/// The point nearest to both of two lines that are not parallel, on the first one.
Eigen::Vector3d crossing(const SymmetryAxis& a, const SymmetryAxis& b) {
  const Eigen::Vector3d normal = a.direction.cross(b.direction);
  const double along = (b.point - a.point).cross(b.direction).dot(normal) / normal.squaredNorm();
  return a.point + along * a.direction;
}

SE3d about(const Eigen::Vector3d& point, const SO3d& rotation) {
  return SE3d(rotation, point - rotation * point);
}

Vector6d generator(const SymmetryAxis& axis) {
  Vector6d twist;
  twist << axis.direction, axis.point.cross(axis.direction);
  return twist;
}

/// A motion g of the group, and what it leaves: rest = (X g)^-1 reference, z = Log(rest).
struct Equivalent {
  Equivalent(const SE3d& g, const SE3d& left, const Matrix6d& information)
      : motion(g), rest(left), z(rest.log()), cost(z.dot(information.lazyProduct(z))) {}

  SE3d motion;
  SE3d rest;
  Vector6d z;
  double cost;
};

/// Gauss-Newton over the angles, Log(Exp(-A eps) rest) = z - J_l^-1(z) A eps + ..., while it
/// promises a gain and a cost below `least`.
template <int N>
void refine(const Eigen::Matrix<double, 6, N>& generators, const Matrix6d& information,
            double least, Equivalent& equivalent) {
  for (int step = 0; step < kMostSteps; ++step) {
    const auto jacobian = SE3d::left_jacobian_inverse_blocks(equivalent.z);
    Eigen::Matrix<double, 6, N> slope;
    for (int i = 0; i < N; ++i) slope.col(i) = jacobian.times(Vector6d(generators.col(i)));
    const Eigen::Matrix<double, 6, N> weighted = information.lazyProduct(slope);
    const Eigen::Matrix<double, N, N> normal = slope.transpose().lazyProduct(weighted);
    const Eigen::Matrix<double, N, 1> pull = weighted.transpose().lazyProduct(equivalent.z);
    const Eigen::Matrix<double, N, 1> eps = normal.inverse() * pull;
    const double gain = pull.dot(eps);
    if (!(gain > kSmallestGain * equivalent.cost && equivalent.cost - gain < least)) return;
    const SE3d turn = SE3d::exp(generators * eps);
    const Equivalent next(equivalent.motion * turn, turn.inverse() * equivalent.rest, information);
    if (!(next.cost < equivalent.cost)) return;
    equivalent = next;
  }
}

[[noreturn]] void fail_axes(std::size_t i, std::size_t j) {
  throw InvalidInput(
      fmt::format("symmetries: axes {} and {} have no common point, so that turns about them make "
                  "up all motions; expected one axis, or axes through one point",
                  i, j));
}

}  // namespace

SymmetryGroup::SymmetryGroup(const std::vector<SE3d>& elements,
                             const std::vector<SymmetryAxis>& axes,
                             const SymmetryTolerance& tolerance) {
  take_axes(axes, tolerance);
  std::vector<Named> all{{SE3d(), "the identity"}};
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const SE3d& motion = elements[i];
    if (!motion.translation().allFinite() || !motion.rotation().quaternion().coeffs().allFinite())
      throw InvalidInput(fmt::format("symmetries: element {} is not finite", i));
    all.push_back({motion, fmt::format("element {} ({})", i, described(motion))});
  }
  require_axes_kept(all, tolerance);
  for (const Named& candidate : all) {
    const bool is_known = std::any_of(elements_.begin(), elements_.end(), [&](const SE3d& known) {
      return are_same(known, candidate.motion, tolerance);
    });
    if (!is_known) elements_.push_back(candidate.motion);
  }
  require_closed(all, tolerance);
  for (const SE3d& element : elements_) inverses_.push_back(element.inverse());
}

void SymmetryGroup::take_axes(const std::vector<SymmetryAxis>& axes,
                              const SymmetryTolerance& tolerance) {
  std::size_t other = 0;  // an axis in another direction than the first
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const SymmetryAxis axis = canonical(axes[i], i);
    if (axes_.empty()) {
      axes_.push_back(axis);
    } else if (are_parallel(axes_[0], axis, tolerance.rotation_rad)) {
      if (distance(axes_[0], axis.point) > tolerance.translation_m) fail_axes(0, i);
    } else if (other == 0) {
      other = i;
      const Eigen::Vector3d centre = crossing(axes_[0], axis);
      if (distance(axis, centre) > tolerance.translation_m) fail_axes(0, i);
      axes_.push_back({axis.direction, centre});
    } else if (distance(axis, axes_[1].point) > tolerance.translation_m) {
      fail_axes(other, i);
    }
  }
  if (axes_.size() == 2) {
    const Eigen::Vector3d centre = axes_[1].point;
    axes_ = {{Eigen::Vector3d::UnitX(), centre},
             {Eigen::Vector3d::UnitY(), centre},
             {Eigen::Vector3d::UnitZ(), centre}};
  }
  generators_.resize(6, static_cast<Eigen::Index>(axes_.size()));
  for (std::size_t i = 0; i < axes_.size(); ++i)
    generators_.col(static_cast<Eigen::Index>(i)) = generator(axes_[i]);
}

void SymmetryGroup::require_axes_kept(const std::vector<Named>& all,
                                      const SymmetryTolerance& tolerance) const {
  if (axes_.empty()) return;
  const bool is_sphere = axes_.size() > 1;
  const SymmetryAxis& axis = axes_.front();
  for (const Named& element : all) {
    const Eigen::Vector3d point = element.motion * axis.point;
    const SymmetryAxis image{element.motion.rotation() * axis.direction, point};
    const bool is_kept = is_sphere ? (point - axis.point).norm() <= tolerance.translation_m
                                   : are_parallel(axis, image, tolerance.rotation_rad) &&
                                         distance(axis, point) <= tolerance.translation_m;
    if (is_kept) continue;
    throw InvalidInput(fmt::format(
        "symmetries: {} moves {} by more than {}, so that the set is no group", element.name,
        is_sphere ? "the common point of the axes" : "axis 0", described(tolerance)));
  }
}

/// Products of representatives suffice, because every element maps the axes onto themselves; a
/// finite set that is closed under composition holds its inverses.
void SymmetryGroup::require_closed(const std::vector<Named>& all,
                                   const SymmetryTolerance& tolerance) const {
  for (const Named& a : all) {
    for (const Named& b : all) {
      const SE3d product = a.motion * b.motion;
      const bool is_there =
          std::any_of(elements_.begin(), elements_.end(),
                      [&](const SE3d& element) { return are_same(element, product, tolerance); });
      if (is_there) continue;
      throw InvalidInput(
          fmt::format("symmetries: the set is no group: {} after {} is {}, which is none of them "
                      "to {}",
                      a.name, b.name, described(product), described(tolerance)));
    }
  }
}

bool SymmetryGroup::are_same(const SE3d& a, const SE3d& b,
                             const SymmetryTolerance& tolerance) const {
  const SE3d between = a.inverse() * b;
  const SE3d rest = turned_to(between).inverse() * between;
  return rest.rotation().angle() <= tolerance.rotation_rad &&
         rest.translation().norm() <= tolerance.translation_m;
}

SE3d SymmetryGroup::turned_to(const SE3d& error) const {
  if (axes_.empty()) return SE3d();
  const SymmetryAxis& axis = axes_.front();
  if (axes_.size() > 1) return about(axis.point, error.rotation());
  const Eigen::Quaterniond& q = error.rotation().quaternion();
  const double angle = 2.0 * std::atan2(q.vec().dot(axis.direction), q.w());
  return about(axis.point, SO3d::exp(angle * axis.direction));
}

SE3d SymmetryGroup::closest(const SE3d& pose, const SE3d& reference,
                            const Matrix6d& information) const {
  if (is_trivial()) return pose;
  const SE3d error = pose.inverse() * reference;
  double least = std::numeric_limits<double>::infinity();
  SE3d best;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const SE3d rest = inverses_[i] * error;
    const SE3d turn = turned_to(rest);
    Equivalent equivalent(elements_[i] * turn, turn.inverse() * rest, information);
    if (axes_.size() == 1) refine<1>(generators_.leftCols<1>(), information, least, equivalent);
    if (axes_.size() == 3) refine<3>(generators_, information, least, equivalent);
    if (!(equivalent.cost < least)) continue;
    least = equivalent.cost;
    best = equivalent.motion;
  }
  return pose * best;
}

Matrix6d SymmetryGroup::unobserved_covariance() const {
  const double variance = std::numbers::pi * std::numbers::pi / 3.0;
  return variance * generators_ * generators_.transpose();
}

}  // namespace posemix
