// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/draw/picture.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "picture_colours.hpp"
#include "picture_map.hpp"
#include "picture_strip.hpp"
#include "svg.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr double kPictureWidth = 1000.0;
constexpr double kPictureLeft = 64.0;
constexpr SvgBox kMap{kPictureLeft, 100.0, 600.0, 460.0};
constexpr double kLegendLeft = 688.0;
constexpr double kStripTop = 636.0;
constexpr double kStripHeight = 84.0;
constexpr double kStripGap = 14.0;
constexpr std::size_t kMostStrips = 8;

std::string centimetres(const std::optional<double>& metres) {
  return metres ? fmt::format("{:.2f} cm", 100.0 * *metres) : "-";
}

std::string degrees_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.2f} deg", *value) : "-";
}

std::string headline(const SlamJob& job, const SlamRun& run, const Metrics& metrics) {
  const double seconds = job.sequence.stamps[run.frames.size() - 1] - job.sequence.stamps.front();
  std::string text = fmt::format("{} frames, {:.4g} s", run.frames.size(), seconds);
  if (!metrics.camera.position_rmse_m) return text + ", no ground truth of the camera";
  return text + fmt::format("; camera error (rms) {}, {}",
                            centimetres(metrics.camera.position_rmse_m),
                            degrees_text(metrics.camera.rotation_rmse_deg));
}

/// Rows of the legend, one below the other.
class Legend {
 public:
  explicit Legend(SvgDocument& svg) : svg_(svg) {}

  void line(std::string_view text, const SvgStyle& style) {
    svg_.line({kLegendLeft, y_ - 4}, {kLegendLeft + 26, y_ - 4}, style);
    row(text);
  }
  void dot(std::string_view text, const SvgStyle& style) {
    svg_.circle({kLegendLeft + 13, y_ - 4}, 4.5, style);
    row(text);
  }
  void ellipse(std::string_view text) {
    svg_.ellipse({kLegendLeft + 13, y_ - 4}, {13, 6}, 0,
                 {.stroke = std::string(kAxisColour), .fill = std::string(kGridColour)});
    row(text);
  }
  void cross(std::string_view text) {
    draw_cross(svg_, {kLegendLeft + 13, y_ - 4});
    row(text);
  }
  void row(std::string_view text) {
    svg_.text({kLegendLeft + 36, y_}, text, {.size = 12.5});
    y_ += 20;
  }
  void object(std::size_t index, const ObjectMetrics& metrics) {
    svg_.rectangle({kLegendLeft + 6, y_ - 11, 14, 12}, {.fill = object_colour(index)});
    svg_.text({kLegendLeft + 36, y_}, metrics.id,
              {.size = 12.5, .fill = object_colour(index), .bold = true});
    y_ += 16;
    const bool known = metrics.relative.rotation_rmse_deg.has_value();
    const std::string errors =
        known ? fmt::format("{}, {}", centimetres(metrics.relative.position_rmse_m),
                            degrees_text(metrics.relative.rotation_rmse_deg))
              : fmt::format("{} detections, {} gated", metrics.detections, metrics.gated);
    svg_.text({kLegendLeft + 36, y_}, errors, {.size = 11.5, .fill = std::string(kAxisColour)});
    y_ += 20;
  }
  void space() { y_ += 8; }
  void heading(std::string_view text) {
    svg_.text({kLegendLeft, y_}, text, {.size = 12.5, .bold = true});
    y_ += 20;
  }

 private:
  SvgDocument& svg_;
  double y_ = kMap.top + 10;
};

void draw_legend(SvgDocument& svg, const SlamJob& job, const Metrics& metrics) {
  const std::string camera(kCameraColour);
  const std::string truth(kTruthColour);
  Legend legend(svg);
  legend.heading("Map");
  legend.line("camera, estimate, with view direction", {.stroke = camera, .width = 1.8});
  if (!job.sequence.camera_truth.empty()) {
    legend.line("camera, ground truth", {.stroke = truth, .width = 1.8, .dash = "6 4"});
  }
  legend.dot("start", {.stroke = camera, .width = 1.6, .fill = "#ffffff"});
  legend.dot("end", {.fill = camera});
  legend.ellipse("3-sigma of the position");
  legend.dot("object at the end", {.fill = object_colour(0)});
  const bool known = std::any_of(
      metrics.objects.begin(), metrics.objects.end(),
      [](const ObjectMetrics& object) { return object.world.position_rmse_m.has_value(); });
  if (known) legend.cross("object, ground truth");
  legend.space();
  legend.heading("Objects relative to the camera (rms)");
  const std::size_t shown = std::min(metrics.objects.size(), kMostStrips);
  for (std::size_t i = 0; i < shown; ++i) legend.object(i, metrics.objects[i]);
  if (shown < metrics.objects.size())
    legend.row(fmt::format("and {} more", metrics.objects.size() - shown));
}

void draw_strips(SvgDocument& svg, const SlamJob& job, const SlamRun& run, const Metrics& metrics,
                 std::size_t shown) {
  const bool known = std::any_of(
      metrics.objects.begin(), metrics.objects.end(),
      [](const ObjectMetrics& object) { return object.relative.rotation_rmse_deg.has_value(); });
  svg.text({kPictureLeft, kStripTop - 10},
           known ? "Rotation of the object relative to the camera [deg]: error of the estimate "
                   "(line) and of the "
                   "detector (dots), 3-sigma width (shade)"
                 : "Rotation of the object relative to the camera [deg]: 3-sigma width",
           {.size = 12.5, .bold = true});
  for (std::size_t i = 0; i < shown; ++i) {
    const double top = kStripTop + static_cast<double>(i) * (kStripHeight + kStripGap);
    draw_strip(svg, {kPictureLeft, top, kPictureWidth - kPictureLeft - 28, kStripHeight}, job, i,
               strip_curves(job, run, i), i + 1 == shown);
  }
}

}  // namespace

std::string format_picture(const SlamJob& job, const SlamRun& run, const Metrics& metrics) {
  const std::size_t shown = std::min(job.models.size(), kMostStrips);
  const double height = kStripTop + static_cast<double>(shown) * (kStripHeight + kStripGap) + 34.0;
  const std::string title = fmt::format("{}: {}", job.name, job.method);
  SvgDocument svg(kPictureWidth, height, title);
  svg.text({kPictureLeft, 34}, title, {.size = 20, .bold = true});
  svg.text({kPictureLeft, 58}, headline(job, run, metrics),
           {.size = 14, .fill = std::string(kAxisColour)});
  draw_map(svg, kMap, job, run);
  draw_legend(svg, job, metrics);
  draw_strips(svg, job, run, metrics, shown);
  return svg.str();
}

}  // namespace posemix
