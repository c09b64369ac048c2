// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/symmetry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "posemix/base/error.hpp"

namespace posemix {

/// An element and its name in messages.
struct SymmetryGroup::Named {
  SE3d motion;
  std::string name;
};

namespace {

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

Vector6d generator(const SymmetryAxis& axis) {
  Vector6d twist;
  twist << axis.direction, axis.point.cross(axis.direction);
  return twist;
}

void require_finite(const std::vector<SE3d>& elements) {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const SE3d& motion = elements[i];
    if (!motion.translation().allFinite() || !motion.rotation().quaternion().coeffs().allFinite())
      throw InvalidInput(fmt::format("symmetries: element {} is not finite", i));
  }
}

/// @throws InvalidInput for a negative number, and where a turn by one step counts as none
void require_distinct_turns(int fold) {
  if (fold < 0) {
    throw InvalidInput(fmt::format(
        "symmetries: {} turns about an axis, expected a number from 1, or 0 for any angle", fold));
  }
  const double tolerance = SymmetryTolerance{}.rotation_rad;
  // Steps of the tolerance itself count as none, whichever way they are rounded.
  const int largest = static_cast<int>(std::ceil(2.0 * std::numbers::pi / tolerance - 1e-6)) - 1;
  if (fold <= largest) return;
  throw InvalidInput(
      fmt::format("symmetries: {} turns about an axis, of which the tolerance of {:.3g} deg takes "
                  "two for one; expected at most {}, or 0 for any angle",
                  fold, degrees(tolerance), largest));
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
  require_finite(elements);
  std::vector<Named> all{{SE3d(), "the identity"}};
  for (std::size_t i = 0; i < elements.size(); ++i)
    all.push_back({elements[i], fmt::format("element {} ({})", i, described(elements[i]))});
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

SymmetryGroup SymmetryGroup::from_stored(std::vector<SE3d> elements,
                                         const std::vector<SymmetryAxis>& axes) {
  require_finite(elements);
  if (elements.empty() || elements.front().log() != Vector6d::Zero())
    throw InvalidInput("symmetries: stored elements, expected the identity as the first");
  SymmetryGroup group;
  group.take_axes(axes, {});
  group.elements_ = std::move(elements);
  group.inverses_.clear();
  for (const SE3d& element : group.elements_) group.inverses_.push_back(element.inverse());
  return group;
}

SymmetryGroup SymmetryGroup::turns(const Eigen::Vector3d& axis, int fold) {
  require_distinct_turns(fold);
  if (fold == 0) return SymmetryGroup({}, {{axis, Eigen::Vector3d::Zero()}});
  const Eigen::Vector3d direction = canonical({axis, Eigen::Vector3d::Zero()}, 0).direction;
  const double step = 2.0 * std::numbers::pi / fold;
  std::vector<SE3d> elements{SE3d()};
  for (int i = 1; i < fold; ++i)
    elements.emplace_back(SO3d::exp(i * step * direction), Eigen::Vector3d::Zero());
  // They are closed, and to check it takes fold^3 products.
  SymmetryGroup group = from_stored(std::move(elements), {});
  group.turns_ = Turns{direction, step};
  return group;
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

}  // namespace posemix
