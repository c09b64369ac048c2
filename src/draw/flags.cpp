// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/draw/flags.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "svg.hpp"

namespace posemix {
namespace {

using namespace internal;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSize = 560.0;
constexpr double kHead = 34.0;

/// Points of space on the picture.
class Projection {
 public:
  explicit Projection(const FlagView& view)
      : centre_(view.centre),
        turn_(SO3<double>::exp({radians(view.pitch_deg), 0.0, 0.0}) *
              SO3<double>::exp({0.0, radians(view.yaw_deg), 0.0})),
        scale_(0.5 * kSize / view.extent) {}

  Vector2d operator()(const Vector3d& point) const {
    const Vector3d seen = turn_ * Vector3d(point - centre_);
    return {0.5 * kSize + scale_ * seen.x(), kHead + 0.5 * kSize + scale_ * seen.y()};
  }
  Vector2d direction(const Vector3d& axis) const { return (turn_ * axis).head<2>(); }

 private:
  Vector3d centre_;
  SO3<double> turn_;
  double scale_;
};

void draw_flag(SvgDocument& svg, const Projection& at, const SE3<double>& pose, double length,
               const std::string& colour) {
  const Vector3d& foot = pose.translation();
  const Vector3d x = pose.rotation() * Vector3d(Vector3d::UnitX());
  const Vector3d z = pose.rotation() * Vector3d(Vector3d::UnitZ());
  const Vector3d top = foot + length * z;
  const std::array pennant{at(top), at(foot + 0.6 * length * z),
                           at(foot + 0.8 * length * z + 0.6 * length * x)};
  svg.line(at(foot), at(top), {.stroke = colour, .width = 1.0, .opacity = 0.5});
  svg.polygon(pennant, {.fill = colour, .opacity = 0.35});
}

void draw_box(SvgDocument& svg, const Projection& at, const OutlinedBox& box) {
  const auto corner = [&](int bits) {
    const Vector3d sign((bits & 1) != 0 ? 0.5 : -0.5, (bits & 2) != 0 ? 0.5 : -0.5,
                        (bits & 4) != 0 ? 0.5 : -0.5);
    return at(box.pose * Vector3d(sign.cwiseProduct(box.size)));
  };
  for (int from = 0; from < 8; ++from) {
    for (const int axis : {1, 2, 4}) {
      if ((from & axis) == 0) {
        svg.line(corner(from), corner(from | axis), {.stroke = "#8A8A8A", .width = 1.2});
      }
    }
  }
}

void draw_triad(SvgDocument& svg, const Projection& at) {
  const Vector2d origin(46.0, kHead + kSize - 46.0);
  constexpr std::array kNames{"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const Vector2d tip = origin + 28.0 * at.direction(Vector3d::Unit(i));
    svg.line(origin, tip, {.stroke = "#555555", .width = 1.5});
    svg.text(tip + Vector2d(3.0, 4.0), kNames[static_cast<std::size_t>(i)],
             {.size = 11.0, .fill = "#555555"});
  }
}

}  // namespace

FlagView view_of(std::span<const FlagGroup> groups, double flag) {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;
  for (const FlagGroup& group : groups) {
    for (const SE3<double>& pose : group.poses) {
      low = low.cwiseMin(pose.translation());
      high = high.cwiseMax(pose.translation());
    }
  }
  if (!low.allFinite()) return {Vector3d::Zero(), 1.0};
  FlagView view{0.5 * (low + high), 0.5 * (high - low).norm() + 1.2 * flag};
  view.flag = flag;
  return view;
}

std::string draw_flags(std::string_view title, std::span<const FlagGroup> groups,
                       const FlagView& view, const std::optional<OutlinedBox>& box) {
  require(view.extent > 0.0 && view.flag > 0.0, "flags: extent and flag must be positive");
  SvgDocument svg(kSize, kSize + kHead, title);
  svg.rectangle({0.0, 0.0, kSize, kSize + kHead}, {.fill = "#FFFFFF"});
  const Projection at(view);
  svg.begin_clip({0.0, kHead, kSize, kSize});
  if (box) draw_box(svg, at, *box);
  for (const FlagGroup& group : groups) {
    for (const SE3<double>& pose : group.poses) draw_flag(svg, at, pose, view.flag, group.colour);
  }
  svg.end_clip();
  draw_triad(svg, at);
  svg.text({12.0, 22.0}, title, {.size = 15.0, .bold = true});
  double y = kHead + 18.0;
  for (const FlagGroup& group : groups) {
    svg.circle({20.0, y - 4.0}, 5.0, {.fill = group.colour});
    svg.text({32.0, y}, group.label, {.halo = true});
    y += 18.0;
  }
  return svg.str();
}

}  // namespace posemix
