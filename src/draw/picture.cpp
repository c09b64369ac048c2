// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/draw/picture.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "picture_colours.hpp"
#include "picture_curves.hpp"
#include "picture_legend.hpp"
#include "picture_map.hpp"
#include "picture_strip.hpp"
#include "posemix/base/words.hpp"
#include "run_consistency.hpp"
#include "slam/run_checks.hpp"
#include "svg.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr double kPictureWidth = 1000.0;
constexpr double kPictureLeft = 64.0;
constexpr double kPictureRight = 28.0;
constexpr SvgBox kMap{kPictureLeft, 100.0, 560.0, 460.0};
constexpr SvgBox kLegend{652.0, 100.0, kPictureWidth - kPictureRight - 652.0, 460.0};
constexpr double kStripTop = 692.0;
constexpr double kStripHeight = 76.0;
constexpr double kStripDistance = 122.0;
constexpr double kNameRise = 22.0;  ///< of the name above its strip
constexpr double kStripGap = 46.0;
constexpr double kProbabilityWidth = 170.0;
constexpr std::size_t kMostStrips = 8;

std::string headline(const SlamJob& job, const SlamRun& run, const Metrics& metrics) {
  const double seconds = job.sequence.stamps[run.frames.size() - 1] - job.sequence.stamps.front();
  std::string text = fmt::format("{} frames, {:.4g} s", run.frames.size(), seconds);
  if (!metrics.camera.position_rmse_m) return text + ", no ground truth of the camera";
  return text + "; camera error (rms) " +
         pose_error_text(metrics.camera.position_rmse_m, metrics.camera.rotation_rmse_deg);
}

/// The strips of a pose.
struct PictureRow {
  std::string name;
  std::string colour;
  PoseCurves curves;
  std::optional<ConsistencyReport> consistency;
};

std::string consistency_text(const ConsistencyReport& report) {
  const std::string fault = fault_text(report);
  return fmt::format("{}: {}{}{}", word_of(report.verdict), nees_text(report.pose),
                     fault.empty() ? "" : "; ", fault);
}

/// The camera, where its truth is known, and the first objects.
std::vector<PictureRow> rows_of(const SlamJob& job, const SlamRun& run) {
  std::vector<PictureRow> rows;
  PoseCurves camera = camera_curves(job, run);
  if (has_values(camera.position.estimate)) {
    rows.push_back({"camera in the world", std::string(kCameraColour), std::move(camera),
                    camera_consistency(job, run)});
  }
  for (std::size_t i = 0; i < std::min(job.models.size(), kMostStrips); ++i) {
    rows.push_back({job.models[i].id, object_colour(i), object_curves(job, run, i),
                    relative_consistency(job, run, i)});
  }
  return rows;
}

/// The columns of the strips: rotation, position, and where a filter tells it, the probability.
struct StripColumns {
  explicit StripColumns(bool has_probability) {
    const double whole = kPictureWidth - kPictureLeft - kPictureRight;
    const double rest = has_probability ? kProbabilityWidth + kStripGap : 0.0;
    const double width = 0.5 * (whole - rest - kStripGap);
    boxes = {SvgBox{kPictureLeft, 0.0, width, kStripHeight},
             SvgBox{kPictureLeft + width + kStripGap, 0.0, width, kStripHeight},
             SvgBox{kPictureWidth - kPictureRight - kProbabilityWidth, 0.0, kProbabilityWidth,
                    kStripHeight}};
  }
  SvgBox at(std::size_t column, double top) const {
    SvgBox box = boxes[column];
    box.top = top;
    return box;
  }
  std::array<SvgBox, 3> boxes;
};

void draw_headings(SvgDocument& svg, const StripColumns& columns, bool known,
                   bool has_probability) {
  const SvgFont bold{.size = 13.5, .bold = true};
  const SvgFont small{.size = 12, .fill = std::string(kAxisColour)};
  const double y = kStripTop - 74.0;
  const char* what = known ? "error" : "99.7 % bound";
  svg.text({kPictureLeft, y}, fmt::format("Rotation, {} [deg]", what), bold);
  svg.text({columns.at(1, 0).left, y}, fmt::format("Position, {} [mm]", what), bold);
  if (has_probability) svg.text({columns.at(2, 0).left, y}, "Mode probability", bold);
  svg.text(
      {kPictureLeft, y + 17.0},
      known
          ? "Objects relative to the camera. Line: estimate; dots: detections; shade: the "
            "norm that 99.7 % of consistent errors are below; triangles: beyond the scale."
          : "Objects relative to the camera. Shade: the norm that 99.7 % of consistent errors are "
            "below.",
      small);
}

void draw_row(SvgDocument& svg, const StripColumns& columns, const std::vector<double>& stamps,
              const PictureRow& row, double top, bool last) {
  svg.text({kPictureLeft, top - kNameRise}, row.name, {.fill = row.colour, .bold = true});
  if (row.consistency) {
    const double left = kPictureLeft + 8.2 * static_cast<double>(row.name.size()) + 14.0;
    svg.text({left, top - kNameRise}, consistency_text(*row.consistency),
             {.size = 12, .fill = std::string(kAxisColour)});
  }
  draw_error_strip(svg, columns.at(0, top), stamps, row.curves.rotation, {row.colour, "deg", last});
  draw_error_strip(svg, columns.at(1, top), stamps, row.curves.position, {row.colour, "mm", last});
  if (!has_values(row.curves.mode_probability)) return;
  draw_probability_strip(svg, columns.at(2, top), stamps, row.curves.mode_probability,
                         {row.colour, "", last});
}

/// The objects that have no strip.
std::string left_out(const SlamJob& job) {
  if (job.models.size() <= kMostStrips) return "";
  std::string text = fmt::format("and {} more objects:", job.models.size() - kMostStrips);
  constexpr std::size_t kWidest = 130;
  for (std::size_t i = kMostStrips; i < job.models.size(); ++i) {
    if (text.size() + job.models[i].id.size() > kWidest) return text + " ...";
    text += (i == kMostStrips ? " " : ", ") + job.models[i].id;
  }
  return text;
}

void draw_strips(SvgDocument& svg, const SlamJob& job, const std::vector<PictureRow>& rows) {
  const auto known = [](const PictureRow& row) { return has_values(row.curves.position.estimate); };
  const auto told = [](const PictureRow& row) { return has_values(row.curves.mode_probability); };
  const bool has_probability = std::any_of(rows.begin(), rows.end(), told);
  const StripColumns columns(has_probability);
  draw_headings(svg, columns, std::any_of(rows.begin(), rows.end(), known), has_probability);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double top = kStripTop + kStripDistance * static_cast<double>(i);
    draw_row(svg, columns, job.sequence.stamps, rows[i], top, i + 1 == rows.size());
  }
  svg.text({kPictureLeft, kStripTop + kStripDistance * static_cast<double>(rows.size()) + 8.0},
           left_out(job), {.size = 12.5});
}

}  // namespace

std::string format_picture(const SlamJob& job, const SlamRun& run, const Metrics& metrics) {
  internal::require_fit(job, run);
  internal::require_fit(job, metrics);
  const std::vector<PictureRow> rows = rows_of(job, run);
  const double strips = kStripDistance * static_cast<double>(rows.size());
  const double more = left_out(job).empty() ? 0.0 : 24.0;
  const std::string title = fmt::format("{}: {}", job.name, job.method);
  SvgDocument svg(kPictureWidth, kStripTop + strips + more, title);
  svg.text({kPictureLeft, 34}, title, {.size = 20, .bold = true});
  svg.text({kPictureLeft, 58}, headline(job, run, metrics),
           {.size = 14, .fill = std::string(kAxisColour)});
  draw_map(svg, kMap, job, run);
  draw_legend(svg, kLegend, job, metrics);
  draw_strips(svg, job, rows);
  return svg.str();
}

}  // namespace posemix
