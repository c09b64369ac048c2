// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/tag_pose.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "posemix/base/error.hpp"
#include "tag_refinement.hpp"
#include "tag_starts.hpp"

namespace posemix {
namespace {

using namespace internal;

/// Least cosine between a corner and the middle of the tag, seen from the camera.
constexpr double kLeastCosine = 0.05;
/// Least area of the image of a tag, relative to the square of its largest extent: corners on one
/// line have none.
constexpr double kLeastArea = 1e-6;
/// Two minima are one if to go from one to the other changes the squared error by less [px^2].
constexpr double kSameMinimum = 1e-8;
constexpr double kSmallestReciprocalCondition = 1e-14;

/// The corners in a camera at the same place that looks at the tag: normalised coordinates, and the
/// rotation from this camera to the real one.
struct VirtualView {
  std::array<Eigen::Vector2d, 4> image;
  SO3d camera_view;
};

std::optional<VirtualView> view_of(const TagCorners& corners, const CameraModel& camera) {
  std::array<Eigen::Vector3d, 4> rays;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::optional<Eigen::Vector3d> seen = ray(camera, corners[i]);
    if (!seen) return std::nullopt;
    rays[i] = *seen;
    middle += *seen;
  }
  VirtualView view;
  view.camera_view =
      SO3d::from_quaternion(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), middle));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d p = view.camera_view.inverse() * rays[i];
    if (!(p.z() > kLeastCosine)) return std::nullopt;
    view.image[i] = p.hnormalized();
  }
  return view;
}

/// Whether the corners run counter-clockwise in the image, as those of a square seen from the
/// front, and enclose an area. They need not be convex: noise can bend a tag that is seen from the
/// side.
bool is_front(const std::array<Eigen::Vector2d, 4>& image) {
  const Eigen::Vector2d u = image[2] - image[0];
  const Eigen::Vector2d v = image[3] - image[1];
  return u.y() * v.x() - u.x() * v.y() > kLeastArea * std::max(u.squaredNorm(), v.squaredNorm());
}

bool is_same(const TagMinimum& a, const TagMinimum& b) {
  const Vector6d step = (a.pose.inverse() * b.pose).log();
  return step.dot(a.information * step) < kSameMinimum;
}

/// Whether the tag is before the camera with its front towards it, and the minimum has full rank.
bool is_sound(const TagMinimum& minimum) {
  const Eigen::Vector3d normal = minimum.pose.rotation() * Eigen::Vector3d::UnitZ();
  if (!(normal.dot(minimum.pose.translation()) < 0.0)) return false;
  const Vector6d scale = minimum.information.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return false;
  const Matrix6d scaled = scale.asDiagonal() * minimum.information * scale.asDiagonal();
  const Eigen::LDLT<Matrix6d> factor(scaled);
  return factor.isPositive() && factor.rcond() > kSmallestReciprocalCondition;
}

void check(const TagCorners& corners, double size, const CameraModel& camera) {
  validate(camera);
  if (!(size > 0.0) || std::isinf(size)) {
    throw InvalidInput(fmt::format("the size of the tag is {}, expected metres above zero", size));
  }
  for (const Eigen::Vector2d& corner : corners) {
    if (!corner.allFinite()) {
      throw InvalidInput(
          fmt::format("a corner is at {} {}, expected pixels", corner.x(), corner.y()));
    }
  }
}

}  // namespace

TagCorners in_apriltag_order(const TagCorners& corners, CornerOrder order) {
  if (order == CornerOrder::apriltag) return corners;
  return {corners[3], corners[2], corners[1], corners[0]};
}

std::array<Eigen::Vector3d, 4> tag_points(double size) {
  const double half = size / 2.0;
  return {{{-half, -half, 0.0}, {half, -half, 0.0}, {half, half, 0.0}, {-half, half, 0.0}}};
}

std::vector<TagMinimum> tag_minima(const TagCorners& corners, double size,
                                   const CameraModel& camera) {
  check(corners, size, camera);
  const std::optional<VirtualView> view = view_of(corners, camera);
  if (!view || !is_front(view->image)) return {};
  std::vector<TagMinimum> minima;
  const auto refine_from = [&](const SE3d& start) {
    const std::optional<TagMinimum> found = refined(start, corners, size, camera);
    if (!found || !is_sound(*found)) return;
    const auto known = [&](const TagMinimum& other) { return is_same(*found, other); };
    if (std::none_of(minima.begin(), minima.end(), known)) minima.push_back(*found);
  };
  for (const SE3d& start : tag_starts(view->image, size))
    refine_from(SE3d(view->camera_view, Eigen::Vector3d::Zero()) * start);
  std::sort(minima.begin(), minima.end(), [](const TagMinimum& a, const TagMinimum& b) {
    return a.squared_error < b.squared_error;
  });
  return minima;
}

}  // namespace posemix
