// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "picture_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "picture_colours.hpp"
#include "picture_labels.hpp"
#include "posemix/base/units.hpp"
#include "position_covariance.hpp"

namespace posemix::internal {
namespace {

constexpr std::string_view kAxisNames = "xyz";
constexpr std::size_t kMostPoints = 2000;
constexpr std::size_t kViewTicks = 28;
constexpr double kSigmas = 3.0;

/// Extent of a set of points.
struct Extent {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;

  void add(const Eigen::Vector3d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

/// A world plane spanned by two axes, and its place in the picture.
class MapView {
 public:
  MapView(const SvgBox& box, const Extent& extent, std::array<Eigen::Index, 2> axes)
      : box_(box), axes_(axes) {
    const double least = 0.05;
    const Eigen::Vector2d size = (plane(extent.high) - plane(extent.low)).cwiseMax(least);
    scale_ = 0.88 * std::min(box.width / size.x(), box.height / size.y());
    centre_ = 0.5 * (plane(extent.low) + plane(extent.high));
  }

  Eigen::Vector2d plane(const Eigen::Vector3d& point) const {
    return {point[axes_[0]], point[axes_[1]]};
  }

  Eigen::Vector2d pixel(const Eigen::Vector2d& p) const {
    return {box_.left + 0.5 * box_.width + scale_ * (p.x() - centre_.x()),
            box_.top + 0.5 * box_.height - scale_ * (p.y() - centre_.y())};
  }
  Eigen::Vector2d pixel(const Eigen::Vector3d& point) const { return pixel(plane(point)); }

  double pixels_per_metre() const { return scale_; }
  const SvgBox& box() const { return box_; }
  char axis_name(std::size_t i) const { return kAxisNames[static_cast<std::size_t>(axes_[i])]; }
  std::array<Eigen::Index, 2> axes() const { return axes_; }
  Eigen::Vector2d low() const { return centre_ - half(); }
  Eigen::Vector2d high() const { return centre_ + half(); }

 private:
  Eigen::Vector2d half() const { return Eigen::Vector2d(box_.width, box_.height) / (2.0 * scale_); }

  SvgBox box_;
  std::array<Eigen::Index, 2> axes_;
  double scale_;
  Eigen::Vector2d centre_;
};

/// The plane across the axis in which the camera moved least; the x-y plane if z is nearly that
/// axis.
std::array<Eigen::Index, 2> choose_axes(const SlamRun& run) {
  Extent path;
  for (const FrameEstimate& frame : run.frames) path.add(frame.camera.mean().translation());
  const Eigen::Vector3d size = path.high - path.low;
  Eigen::Index least = 0;
  size.minCoeff(&least);
  if (size.z() <= 1.25 * size[least] || least == 2) return {0, 1};
  return least == 0 ? std::array<Eigen::Index, 2>{1, 2} : std::array<Eigen::Index, 2>{0, 2};
}

std::vector<Eigen::Vector3d> estimated_path(const SlamRun& run) {
  const std::size_t stride = 1 + run.frames.size() / kMostPoints;
  std::vector<Eigen::Vector3d> path;
  for (std::size_t k = 0; k < run.frames.size(); k += stride)
    path.push_back(run.frames[k].camera.mean().translation());
  return path;
}

std::vector<Eigen::Vector3d> true_path(const SlamJob& job) {
  const std::size_t stride = 1 + job.sequence.camera_truth.size() / kMostPoints;
  std::vector<Eigen::Vector3d> path;
  for (std::size_t k = 0; k < job.sequence.camera_truth.size(); k += stride) {
    const auto& pose = job.sequence.camera_truth[k];
    if (pose) path.push_back(pose->translation());
  }
  return path;
}

std::optional<SE3d> last_truth(const SlamJob& job, const SlamRun& run, std::size_t object) {
  for (std::size_t k = run.frames.size(); k-- > 0;) {
    if (auto truth = true_world_pose(job.sequence, object, k)) return truth;
  }
  return std::nullopt;
}

Extent extent_of(const SlamJob& job, const SlamRun& run) {
  Extent extent;
  for (const auto& point : estimated_path(run)) extent.add(point);
  for (const auto& point : true_path(job)) extent.add(point);
  for (std::size_t object = 0; object < job.models.size(); ++object) {
    const auto& density = run.frames.back().objects[object];
    if (density) extent.add(density->mean().translation());
  }
  return extent;
}

void draw_polyline(SvgDocument& svg, const MapView& view, const std::vector<Eigen::Vector3d>& path,
                   const SvgStyle& style) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(path.size());
  for (const auto& point : path) points.push_back(view.pixel(point));
  svg.polyline(points, style);
}

/// Covariance of the position in the plane.
Eigen::Matrix2d plane_covariance(const MapView& view, const PoseDensity& density) {
  const std::array<Eigen::Index, 2> axes = view.axes();
  return position_covariance(density)(axes, axes);
}

void draw_ellipse(SvgDocument& svg, const MapView& view, const PoseDensity& density,
                  const std::string& colour) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(plane_covariance(view, density));
  const double largest = 4.0 * (view.box().width + view.box().height);
  const Eigen::Vector2d radii =
      (kSigmas * view.pixels_per_metre() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt())
          .cwiseMin(largest);
  const Eigen::Vector2d axis = eigen.eigenvectors().col(0);
  const double angle = -degrees(std::atan2(axis.y(), axis.x()));
  const Eigen::Vector2d centre = view.pixel(density.mean().translation());
  svg.ellipse(centre, radii, angle, {.fill = colour, .opacity = 0.25});
  svg.ellipse(centre, radii, angle, {.stroke = colour, .width = 0.9, .opacity = 0.8});
}

/// Ellipses of the camera's position and short lines along its optical axis.
void draw_camera_marks(SvgDocument& svg, const MapView& view, const SlamRun& run) {
  const std::size_t stride = std::max<std::size_t>(1, run.frames.size() / kViewTicks);
  const double length = 16.0 / view.pixels_per_metre();
  for (std::size_t k = 0; k < run.frames.size(); k += stride) {
    const SE3d& camera = run.frames[k].camera.mean();
    draw_ellipse(svg, view, run.frames[k].camera, std::string(kTruthColour));
    const Eigen::Vector3d ahead = camera * Eigen::Vector3d(0, 0, length);
    svg.line(view.pixel(camera.translation()), view.pixel(ahead),
             {.stroke = std::string(kCameraColour), .opacity = 0.45});
  }
}

/// The length of the scale's bar [m], a round number.
double scale_length_m(const MapView& view) {
  return round_step(view.box().width / view.pixels_per_metre(), 8);
}

/// Where the scale is drawn.
SvgBox scale_box(const MapView& view) {
  const double width = scale_length_m(view) * view.pixels_per_metre();
  return {view.box().left + 10.0, view.box().bottom() - 40.0, width + 12.0, 34.0};
}

void draw_scale(SvgDocument& svg, const MapView& view) {
  const SvgBox& box = view.box();
  const double length_m = scale_length_m(view);
  const Eigen::Vector2d from(box.left + 16, box.bottom() - 16);
  const Eigen::Vector2d to = from + Eigen::Vector2d(length_m * view.pixels_per_metre(), 0);
  const SvgStyle style{.stroke = std::string(kCameraColour), .width = 2};
  svg.line(from, to, style);
  for (const auto& end : {from, to})
    svg.line(end - Eigen::Vector2d(0, 4), end + Eigen::Vector2d(0, 4), style);
  const std::string label =
      length_m < 1.0 ? fmt::format("{:.4g} mm", 1e3 * length_m) : fmt::format("{:.4g} m", length_m);
  svg.text(0.5 * (from + to) - Eigen::Vector2d(0, 8), label,
           {.size = 12, .anchor = SvgAnchor::middle});
}

/// Estimates at the end and true positions, and what their labels keep clear of.
void draw_objects(SvgDocument& svg, const MapView& view, const SlamJob& job, const SlamRun& run) {
  std::vector<PointLabel> labels;
  std::vector<SvgBox> marks{scale_box(view)};
  for (std::size_t object = 0; object < job.models.size(); ++object) {
    const auto& density = run.frames.back().objects[object];
    if (!density) continue;
    const std::string colour = object_colour(object);
    draw_ellipse(svg, view, *density, colour);
    const Eigen::Vector2d centre = view.pixel(density->mean().translation());
    if (const auto truth = last_truth(job, run, object)) {
      const ErrorReduction reduction(job.models[object].symmetries);
      const SE3d nearest = reduction.nearest(*truth, density->mean());
      const Eigen::Vector2d at = view.pixel(nearest.translation());
      draw_cross(svg, at);
      marks.push_back({at.x() - 5.0, at.y() - 5.0, 10.0, 10.0});
    }
    svg.circle(centre, 2.6, {.fill = colour});
    labels.push_back({job.models[object].id, colour, centre});
  }
  draw_point_labels(svg, labels, view.box(), marks);
}

void draw_grid(SvgDocument& svg, const MapView& view) {
  const SvgBox& box = view.box();
  const double step = round_step(std::max(box.width, box.height) / view.pixels_per_metre(), 9);
  const SvgStyle style{.stroke = std::string(kGridColour)};
  // Of recordings that are extreme the step may be none.
  const double digits = std::ceil(-std::log10(step) - 1e-9);
  const int decimals = static_cast<int>(std::isfinite(digits) ? std::clamp(digits, 0.0, 17.0) : 0);
  const auto label = [&](double value) { return fmt::format("{:.{}f}", value + 0.0, decimals); };
  for (double i = std::ceil(view.low().x() / step); i * step <= view.high().x(); ++i) {
    const double x = view.pixel(Eigen::Vector2d(i * step, 0)).x();
    svg.line({x, box.top}, {x, box.bottom()}, style);
    svg.text({x, box.bottom() + 15}, label(i * step),
             {.size = 11, .fill = std::string(kAxisColour), .anchor = SvgAnchor::middle});
  }
  for (double i = std::ceil(view.low().y() / step); i * step <= view.high().y(); ++i) {
    const double y = view.pixel(Eigen::Vector2d(0, i * step)).y();
    svg.line({box.left, y}, {box.right(), y}, style);
    svg.text({box.left - 6, y + 4}, label(i * step),
             {.size = 11, .fill = std::string(kAxisColour), .anchor = SvgAnchor::end});
  }
}

}  // namespace

void draw_cross(SvgDocument& svg, const Eigen::Vector2d& at) {
  const SvgStyle style{.stroke = std::string(kTruthColour), .width = 1.6};
  const Eigen::Vector2d a(4.5, 4.5);
  const Eigen::Vector2d b(4.5, -4.5);
  svg.line(at - a, at + a, style);
  svg.line(at - b, at + b, style);
}

void draw_map(SvgDocument& svg, const SvgBox& box, const SlamJob& job, const SlamRun& run) {
  const MapView view(box, extent_of(job, run), choose_axes(run));
  draw_grid(svg, view);
  svg.begin_clip(box);
  draw_polyline(svg, view, true_path(job),
                {.stroke = std::string(kTruthColour), .width = 1.6, .dash = "6 4"});
  draw_camera_marks(svg, view, run);
  draw_polyline(svg, view, estimated_path(run),
                {.stroke = std::string(kCameraColour), .width = 1.6});
  svg.circle(view.pixel(run.frames.front().camera.mean().translation()), 4.5,
             {.stroke = std::string(kCameraColour), .width = 1.6, .fill = "#ffffff"});
  svg.circle(view.pixel(run.frames.back().camera.mean().translation()), 4.5,
             {.fill = std::string(kCameraColour)});
  draw_objects(svg, view, job, run);
  draw_scale(svg, view);
  svg.end_clip();
  svg.rectangle(box, {.stroke = std::string(kAxisColour)});
  const SvgFont font{.size = 12, .fill = std::string(kAxisColour), .anchor = SvgAnchor::end};
  svg.text({box.right(), box.bottom() + 30}, fmt::format("world {} [m]", view.axis_name(0)), font);
  svg.text({box.left + 76, box.top - 7}, fmt::format("world {} [m]", view.axis_name(1)), font);
}

}  // namespace posemix::internal
