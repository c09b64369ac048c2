// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "picture_strip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "picture_colours.hpp"
#include "posemix/base/statistics.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kMostCurvePoints = 1000;
constexpr double kLeastBetweenCarets = 5.0;
/// A time axis has at least this length [s], and this part of the stamps: less is lost in their
/// rounding.
constexpr double kLeastSpan = 1e-3;
constexpr double kLeastOfStamp = 1e-12;
/// Stamps beyond this [s], as those of Unix, are told from the first one on.
constexpr double kLongestAgo = 1e5;

double quantile_of(const Curve& curve, double probability) {
  std::vector<double> values;
  for (const auto& value : curve) {
    if (value) values.push_back(*value);
  }
  return values.empty() ? 0.0 : quantile(std::move(values), probability);
}

/// Upper end of the error axis: it includes nearly all errors of the estimate, and those of the
/// detections only as far as the estimate stays readable.
double highest_of(const ErrorCurves& curves) {
  const double estimate = quantile_of(curves.estimate, 0.97);
  const double width = quantile_of(curves.width, 0.9);
  const double detector = quantile_of(curves.detector, 0.9);
  double highest = estimate > 0.0
                       ? std::max(estimate, std::min(std::max(width, detector), 2.5 * estimate))
                       : width;
  highest = std::max(1.1 * highest, 0.1);
  const double step = round_step(highest, 4);
  return step * std::ceil(highest / step);
}

/// Maps time and error to pixels.
class StripView {
 public:
  StripView(const SvgBox& box, const std::vector<double>& stamps, double highest)
      : box_(box),
        first_(stamps.front()),
        span_(std::max(
            {stamps.back() - stamps.front(), kLeastSpan, kLeastOfStamp * std::abs(stamps.back())})),
        highest_(highest) {}

  double x(double stamp) const { return box_.left + box_.width * (stamp - first_) / span_; }
  /// Far beyond the scale the drawing is cut anyway.
  double y(double value) const {
    return box_.bottom() - box_.height * std::min(value / highest_, 10.0);
  }

  const SvgBox& box() const { return box_; }
  double first() const { return first_; }
  double span() const { return span_; }
  double highest() const { return highest_; }

 private:
  SvgBox box_;
  double first_;
  double span_;
  double highest_;
};

/// Pieces of a curve without gaps. Of a long one every point is the largest value of some frames.
std::vector<std::vector<Eigen::Vector2d>> pieces(const StripView& view,
                                                 const std::vector<double>& stamps,
                                                 const Curve& curve) {
  const std::size_t stride = 1 + curve.size() / kMostCurvePoints;
  std::vector<std::vector<Eigen::Vector2d>> result(1);
  for (std::size_t k = 0; k < curve.size(); k += stride) {
    const auto end = curve.begin() + static_cast<long>(std::min(k + stride, curve.size()));
    const auto largest = *std::max_element(curve.begin() + static_cast<long>(k), end);
    if (largest) {
      result.back().emplace_back(view.x(stamps[k]), view.y(*largest));
    } else if (!result.back().empty()) {
      result.emplace_back();
    }
  }
  return result;
}

void draw_band(SvgDocument& svg, const StripView& view, const std::vector<double>& stamps,
               const Curve& width, const std::string& colour) {
  for (std::vector<Eigen::Vector2d> outline : pieces(view, stamps, width)) {
    if (outline.size() < 2) continue;
    outline.emplace_back(outline.back().x(), view.box().bottom());
    outline.emplace_back(outline.front().x(), view.box().bottom());
    svg.polygon(outline, {.fill = colour, .opacity = 0.16});
  }
}

/// The frames whose value is beyond the scale: how many, and the largest of them.
struct Beyond {
  std::size_t count = 0;
  double largest = 0.0;
};

/// Marks what is beyond the scale at the upper edge, where marks have room.
Beyond draw_beyond(SvgDocument& svg, const StripView& view, const std::vector<double>& stamps,
                   const Curve& curve, const SvgStyle& style) {
  Beyond beyond;
  double last = -std::numeric_limits<double>::infinity();
  const double top = view.box().top + 1.5;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    if (!curve[k] || *curve[k] <= view.highest()) continue;
    ++beyond.count;
    beyond.largest = std::max(beyond.largest, *curve[k]);
    const double x = view.x(stamps[k]);
    if (x - last < kLeastBetweenCarets) continue;
    last = x;
    const std::array caret{Eigen::Vector2d(x, top), Eigen::Vector2d(x - 3.5, top + 6.0),
                           Eigen::Vector2d(x + 3.5, top + 6.0)};
    svg.polygon(caret, style);
  }
  return beyond;
}

std::string beyond_text(const Beyond& beyond, const char* what, const std::string& unit) {
  return fmt::format("{} {}{} (to {:.3g} {})", beyond.count, what, beyond.count == 1 ? "" : "s",
                     beyond.largest, unit);
}

void draw_detections(SvgDocument& svg, const StripView& view, const std::vector<double>& stamps,
                     const Curve& curve, const std::string& colour) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    if (curve[k] && *curve[k] <= view.highest())
      points.emplace_back(view.x(stamps[k]), view.y(*curve[k]));
  }
  svg.dots(points, {.stroke = colour, .width = 1.8, .opacity = 0.4});
}

void draw_time_axis(SvgDocument& svg, const StripView& view) {
  const SvgBox& box = view.box();
  const double step = round_step(view.span(), 5);
  const double zero = std::abs(view.first()) > kLongestAgo ? view.first() : 0.0;
  const double first = view.first() - zero;
  for (double i = std::ceil(first / step); i * step <= first + view.span(); ++i) {
    svg.text({view.x(zero + i * step), box.bottom() + 15}, fmt::format("{:.6g}", i * step),
             {.size = 11, .fill = std::string(kAxisColour), .anchor = SvgAnchor::middle});
  }
  const std::string label = zero == 0.0 ? "time [s]" : fmt::format("time [s] since {:.1f}", zero);
  svg.text({box.right(), box.bottom() + 30}, label,
           {.size = 12, .fill = std::string(kAxisColour), .anchor = SvgAnchor::end});
}

void draw_axes(SvgDocument& svg, const StripView& view, const StripStyle& style) {
  const SvgBox& box = view.box();
  const double step = round_step(view.highest(), 3);
  for (double value = 0.0; value <= view.highest() * (1.0 + 1e-9); value += step) {
    svg.line({box.left, view.y(value)}, {box.right(), view.y(value)},
             {.stroke = std::string(kGridColour)});
    svg.text({box.left - 6, view.y(value) + 4}, fmt::format("{:.4g}", value),
             {.size = 11, .fill = std::string(kAxisColour), .anchor = SvgAnchor::end});
  }
  if (style.has_time_axis) draw_time_axis(svg, view);
}

void draw_line(SvgDocument& svg, const StripView& view, const std::vector<double>& stamps,
               const Curve& curve, const std::string& colour) {
  for (const auto& piece : pieces(view, stamps, curve)) {
    svg.polyline(piece, {.stroke = colour, .width = 1.4});
    if (piece.size() == 1) svg.circle(piece.front(), 1.4, {.fill = colour});
  }
}

void draw_frame(SvgDocument& svg, const SvgBox& box) {
  svg.rectangle(box, {.stroke = std::string(kAxisColour), .width = 0.8});
}

}  // namespace

void draw_error_strip(SvgDocument& svg, const SvgBox& box, const std::vector<double>& stamps,
                      const ErrorCurves& curves, const StripStyle& style) {
  const StripView view(box, stamps, highest_of(curves));
  draw_axes(svg, view, style);
  svg.begin_clip(box);
  draw_band(svg, view, stamps, curves.width, style.colour);
  draw_detections(svg, view, stamps, curves.detector, style.colour);
  draw_line(svg, view, stamps, curves.estimate, style.colour);
  const Beyond detections = draw_beyond(svg, view, stamps, curves.detector,
                                        {.stroke = style.colour, .width = 0.8, .fill = "#ffffff"});
  const Beyond estimates = draw_beyond(svg, view, stamps, curves.estimate, {.fill = style.colour});
  svg.end_clip();
  draw_frame(svg, box);
  std::string text = estimates.count > 0 ? beyond_text(estimates, "estimate", style.unit) : "";
  if (detections.count > 0)
    text += (text.empty() ? "" : ", ") + beyond_text(detections, "detection", style.unit);
  if (text.empty()) return;
  svg.text({box.right(), box.top - 5}, "beyond: " + text,
           {.size = 10, .fill = std::string(kAxisColour), .anchor = SvgAnchor::end});
}

void draw_probability_strip(SvgDocument& svg, const SvgBox& box, const std::vector<double>& stamps,
                            const Curve& curve, const StripStyle& style) {
  const StripView view(box, stamps, 1.0);
  draw_axes(svg, view, style);
  svg.begin_clip({box.left, box.top - 1, box.width, box.height + 2});
  draw_line(svg, view, stamps, curve, style.colour);
  svg.end_clip();
  draw_frame(svg, box);
}

}  // namespace posemix::internal
