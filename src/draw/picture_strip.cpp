// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "picture_strip.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "picture_colours.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kMostCurvePoints = 2000;

/// Against the nearest of the equivalent truths.
std::optional<double> rotation_error_deg(const std::optional<SE3d>& estimate,
                                         const std::optional<SE3d>& truth,
                                         const ErrorReduction& reduction) {
  if (!estimate || !truth) return std::nullopt;
  const SE3d nearest = reduction.nearest(*truth, *estimate);
  return degrees((estimate->rotation() * nearest.rotation().inverse()).log().norm());
}

/// 3 sigma about the least certain axis that can be observed.
std::optional<double> width_deg(const PoseDensity& density, const ErrorReduction& reduction) {
  if (reduction.rotation_dof() == 0) return std::nullopt;
  const auto sd_deg = [](const auto& rotation) {
    using Matrix = std::decay_t<decltype(rotation)>;
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(rotation, Eigen::EigenvaluesOnly);
    return degrees(3.0 * std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff())));
  };
  if (reduction.rotation_dof() < 3) return sd_deg(reduction.rotation_covariance(density));
  return sd_deg(Eigen::Matrix3d(density.covariance().topLeftCorner<3, 3>()));
}

double quantile_of(const Curve& curve, double probability) {
  std::vector<double> values;
  for (const auto& value : curve) {
    if (value) values.push_back(*value);
  }
  return values.empty() ? 0.0 : quantile(std::move(values), probability);
}

/// Upper end of the error axis: it includes nearly all errors of the estimate, and those of the
/// detections only as far as the estimate stays readable.
double highest_of(const StripCurves& curves) {
  const double estimate = quantile_of(curves.estimate, 0.97);
  const double width = quantile_of(curves.width, 0.9);
  const double detector = quantile_of(curves.detector, 0.9);
  double highest = estimate > 0.0
                       ? std::max(estimate, std::min(std::max(width, detector), 2.5 * estimate))
                       : width;
  highest = std::clamp(1.1 * highest, 0.1, 185.0);
  const double step = round_step(highest, 4);
  return step * std::ceil(highest / step);
}

/// Maps time and error to pixels.
class StripView {
 public:
  StripView(const SvgBox& box, const std::vector<double>& stamps, double highest)
      : box_(box),
        first_(stamps.front()),
        span_(std::max(stamps.back() - stamps.front(), 1e-9)),
        highest_(highest) {}

  double x(double stamp) const { return box_.left + box_.width * (stamp - first_) / span_; }
  double y(double value) const {
    return box_.bottom() - box_.height * std::min(value / highest_, 1.0);
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

/// Pieces of a curve without gaps.
std::vector<std::vector<Eigen::Vector2d>> pieces(const StripView& view,
                                                 const std::vector<double>& stamps,
                                                 const Curve& curve) {
  const std::size_t stride = 1 + curve.size() / kMostCurvePoints;
  std::vector<std::vector<Eigen::Vector2d>> result(1);
  for (std::size_t k = 0; k < curve.size(); k += stride) {
    if (curve[k]) {
      result.back().emplace_back(view.x(stamps[k]), view.y(*curve[k]));
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

void draw_detector(SvgDocument& svg, const StripView& view, const std::vector<double>& stamps,
                   const Curve& curve, const std::string& colour) {
  std::vector<Eigen::Vector2d> points;
  for (const auto& piece : pieces(view, stamps, curve))
    points.insert(points.end(), piece.begin(), piece.end());
  svg.dots(points, {.stroke = colour, .width = 1.8, .opacity = 0.4});
}

void draw_axes(SvgDocument& svg, const StripView& view, bool with_time) {
  const SvgBox& box = view.box();
  const SvgStyle grid{.stroke = std::string(kGridColour)};
  const SvgFont font{.size = 11, .fill = std::string(kAxisColour), .anchor = SvgAnchor::end};
  const double step = round_step(view.highest(), 3);
  for (double value = 0.0; value <= view.highest() * (1.0 + 1e-9); value += step) {
    svg.line({box.left, view.y(value)}, {box.right(), view.y(value)}, grid);
    svg.text({box.left - 6, view.y(value) + 4}, fmt::format("{:.4g}", value), font);
  }
  if (!with_time) return;
  const double time_step = round_step(view.span(), 8);
  for (double i = std::ceil(view.first() / time_step); i * time_step <= view.first() + view.span();
       ++i) {
    svg.text({view.x(i * time_step), box.bottom() + 15}, fmt::format("{:.6g}", i * time_step),
             {.size = 11, .fill = std::string(kAxisColour), .anchor = SvgAnchor::middle});
  }
  svg.text({box.right(), box.bottom() + 30}, "time [s]",
           {.size = 12, .fill = std::string(kAxisColour), .anchor = SvgAnchor::end});
}

}  // namespace

StripCurves strip_curves(const SlamJob& job, const SlamRun& run, std::size_t object) {
  const ErrorReduction reduction(job.models[object].symmetries);
  StripCurves curves;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const auto truth = true_relative_pose(job.sequence, object, k);
    const auto& density = run.frames[k].relative[object];
    const auto mean = density ? std::optional(density->mean()) : std::nullopt;
    curves.estimate.push_back(rotation_error_deg(mean, truth, reduction));
    curves.detector.push_back(
        rotation_error_deg(job.sequence.objects[object].detections[k], truth, reduction));
    curves.width.push_back(density ? width_deg(*density, reduction) : std::nullopt);
  }
  return curves;
}

void draw_strip(SvgDocument& svg, const SvgBox& box, const SlamJob& job, std::size_t object,
                const StripCurves& curves, bool last) {
  const std::vector<double>& stamps = job.sequence.stamps;
  const StripView view(box, stamps, highest_of(curves));
  const std::string colour = object_colour(object);
  draw_axes(svg, view, last);
  draw_band(svg, view, stamps, curves.width, colour);
  draw_detector(svg, view, stamps, curves.detector, colour);
  for (const auto& piece : pieces(view, stamps, curves.estimate))
    svg.polyline(piece, {.stroke = colour, .width = 1.4});
  svg.rectangle(box, {.stroke = std::string(kAxisColour), .width = 0.8});
  svg.text({box.left + 8, box.top + 15}, job.models[object].id,
           {.fill = colour, .bold = true, .halo = true});
}

}  // namespace posemix::internal
