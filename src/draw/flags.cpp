// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/draw/flags.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "picture_colours.hpp"
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
constexpr double kSide = 220.0;  ///< for the legend, beside the drawing

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
        svg.line(corner(from), corner(from | axis),
                 {.stroke = std::string(kTruthColour), .width = 1.2});
      }
    }
  }
}

void draw_triad(SvgDocument& svg, const Projection& at) {
  const Vector2d origin(46.0, kHead + kSize - 46.0);
  constexpr std::array kNames{"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const std::string colour(kAxisColours[static_cast<std::size_t>(i)]);
    const Vector2d tip = origin + 28.0 * at.direction(Vector3d::Unit(i));
    svg.line(origin, tip, {.stroke = colour, .width = 1.8});
    svg.text(tip + Vector2d(3.0, 4.0), kNames[static_cast<std::size_t>(i)],
             {.size = 11.0, .fill = colour, .bold = true});
  }
}

/// The eye is far away, so that a length is the same everywhere.
void draw_length(SvgDocument& svg, const FlagView& view) {
  const double metre = 0.5 * kSize / view.extent;
  const double length_m = round_step(2.0 * view.extent, 6);
  const Vector2d to(kSize - 16.0, kHead + kSize - 18.0);
  const Vector2d from = to - Vector2d(length_m * metre, 0.0);
  const SvgStyle style{.stroke = std::string(kCameraColour), .width = 2};
  svg.line(from, to, style);
  for (const auto& end : {from, to}) svg.line(end - Vector2d(0, 4), end + Vector2d(0, 4), style);
  svg.text(0.5 * (from + to) - Vector2d(0, 8), fmt::format("{:.4g} mm", 1e3 * length_m),
           {.size = 12, .anchor = SvgAnchor::middle, .halo = true});
}

/// What the colours and the marks mean; a single group that is called as the picture needs no name.
void draw_side(SvgDocument& svg, std::string_view title, std::span<const FlagGroup> groups,
               bool has_box) {
  const double left = kSize + 12.0;
  double y = kHead + 18.0;
  for (const FlagGroup& group : groups) {
    if (groups.size() == 1 && group.label == title) continue;
    svg.circle({left + 8.0, y - 4.0}, 5.0, {.fill = group.colour});
    svg.text({left + 20.0, y}, group.label);
    y += 20.0;
  }
  y += 8.0;
  const SvgFont font{.size = 12, .fill = std::string(kAxisColour)};
  for (const char* line : {"A flag is a pose: its foot is the",
                           "position, its pole the z axis, its", "tip points along the x axis."}) {
    svg.text({left, y}, line, font);
    y += 17.0;
  }
  if (has_box) svg.text({left, y + 4.0}, "Grey lines: the true box.", font);
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
  SvgDocument svg(kSize + kSide, kSize + kHead, title);
  const Projection at(view);
  svg.begin_clip({0.0, kHead, kSize, kSize});
  if (box) draw_box(svg, at, *box);
  for (const FlagGroup& group : groups) {
    for (const SE3<double>& pose : group.poses) draw_flag(svg, at, pose, view.flag, group.colour);
  }
  svg.end_clip();
  draw_triad(svg, at);
  svg.text({12.0, 22.0}, title, {.size = 15.0, .bold = true});
  draw_length(svg, view);
  draw_side(svg, title, groups, box.has_value());
  return svg.str();
}

}  // namespace posemix
