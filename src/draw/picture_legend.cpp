// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "picture_legend.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "picture_colours.hpp"
#include "picture_map.hpp"

namespace posemix::internal {
namespace {

constexpr double kSignWidth = 26.0;
constexpr double kTextLeft = 36.0;
constexpr double kRow = 18.0;

/// Rows of the legend, one below the other.
class LegendRows {
 public:
  LegendRows(SvgDocument& svg, const SvgBox& box) : svg_(svg), box_(box), y_(box.top + 10.0) {}

  void line(std::string_view text, const SvgStyle& style) {
    svg_.line({box_.left, y_ - 4}, {box_.left + kSignWidth, y_ - 4}, style);
    row(text);
  }
  void dot(std::string_view text, const SvgStyle& style) {
    svg_.circle(sign(), 4.5, style);
    row(text);
  }
  void ellipse(std::string_view text) {
    svg_.ellipse(sign(), {13, 6}, 0,
                 {.stroke = std::string(kAxisColour), .fill = std::string(kGridColour)});
    row(text);
  }
  void cross(std::string_view text) {
    draw_cross(svg_, sign());
    row(text);
  }
  void row(std::string_view text) {
    svg_.text({box_.left + kTextLeft, y_}, text, {.size = 12.5});
    y_ += kRow;
  }
  void object(std::size_t index, const ObjectMetrics& metrics) {
    svg_.rectangle({box_.left + 7, y_ - 11, 12, 12}, {.fill = object_colour(index)});
    svg_.text({box_.left + kTextLeft, y_}, metrics.id,
              {.size = 12.5, .fill = object_colour(index), .bold = true});
    const bool known = metrics.relative.rotation_rmse_deg.has_value();
    const std::string errors = known ? pose_error_text(metrics.relative.position_rmse_m,
                                                       metrics.relative.rotation_rmse_deg)
                                     : fmt::format("{} detections", metrics.detections);
    svg_.text({box_.right(), y_}, errors,
              {.size = 11.5, .fill = std::string(kAxisColour), .anchor = SvgAnchor::end});
    y_ += kRow;
  }
  void heading(std::string_view text) {
    svg_.text({box_.left, y_}, text, {.size = 12.5, .bold = true});
    y_ += kRow;
  }
  void space() { y_ += 8; }
  /// How many rows there is room for.
  std::size_t rows_left() const {
    return static_cast<std::size_t>(std::max(0.0, (box_.bottom() - y_) / kRow + 1.0));
  }

 private:
  Eigen::Vector2d sign() const { return {box_.left + 0.5 * kSignWidth, y_ - 4}; }

  SvgDocument& svg_;
  SvgBox box_;
  double y_;
};

void draw_signs(LegendRows& rows, const SlamJob& job, const Metrics& metrics) {
  const std::string camera(kCameraColour);
  rows.heading("Map");
  rows.line("camera, estimate, with view direction", {.stroke = camera, .width = 1.8});
  if (!job.sequence.camera_truth.empty()) {
    rows.line("camera, ground truth",
              {.stroke = std::string(kTruthColour), .width = 1.8, .dash = "6 4"});
  }
  rows.dot("start", {.stroke = camera, .width = 1.6, .fill = "#ffffff"});
  rows.dot("end", {.fill = camera});
  rows.ellipse("3-sigma of the position");
  rows.dot("object at the end", {.fill = object_colour(0)});
  const bool known = std::any_of(
      metrics.objects.begin(), metrics.objects.end(),
      [](const ObjectMetrics& object) { return object.world.position_rmse_m.has_value(); });
  if (known) rows.cross("object, ground truth");
  rows.space();
}

}  // namespace

std::string pose_error_text(const std::optional<double>& metres,
                            const std::optional<double>& degrees) {
  return (metres ? fmt::format("{:.3g} mm, ", 1e3 * *metres) : std::string("-, ")) +
         (degrees ? fmt::format("{:.3g} deg", *degrees) : std::string("-"));
}

void draw_legend(SvgDocument& svg, const SvgBox& box, const SlamJob& job, const Metrics& metrics) {
  LegendRows rows(svg, box);
  draw_signs(rows, job, metrics);
  rows.heading("Objects relative to the camera, error (rms)");
  const std::size_t room = rows.rows_left();
  const bool all = metrics.objects.size() <= room;
  const std::size_t shown = all ? metrics.objects.size() : room - 1;
  for (std::size_t i = 0; i < shown; ++i) rows.object(i, metrics.objects[i]);
  if (!all) rows.row(fmt::format("and {} more", metrics.objects.size() - shown));
}

}  // namespace posemix::internal
