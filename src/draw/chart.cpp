// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/draw/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "chart_axis.hpp"
#include "chart_legend.hpp"
#include "chart_panel.hpp"
#include "picture_colours.hpp"
#include "posemix/base/error.hpp"
#include "svg.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr double kWidth = 720.0;
constexpr double kHeight = 440.0;
constexpr double kLeastPanelWidth = 300.0;
constexpr double kPanelHeight = 290.0;
constexpr double kMargin = 14.0;
constexpr double kTitleSize = 17.0;
constexpr double kTitleHeight = 36.0;
constexpr double kNoteSize = 12.5;
constexpr double kNoteHeight = 20.0;

/// The font size, at most `size`, at which a text fits a width.
double fitting_size(double size, std::string_view text, double width) {
  return std::min(size,
                  width / (kCharacterWidth * std::max(1.0, static_cast<double>(text.size()))));
}

void check_range(const std::optional<ChartRange>& range, bool log, std::string_view axis) {
  if (!range) return;
  const bool fits =
      shows(range->first, log) && shows(range->second, log) && range->first < range->second;
  if (fits) return;
  throw InvalidInput(
      fmt::format("chart: the range of {} is {:g} to {:g}, expected two {}numbers "
                  "in ascending order",
                  axis, range->first, range->second, log ? "positive " : ""));
}

void check(const Chart& chart) {
  check_range(chart.x_range, chart.log_x, "x");
  check_range(chart.y_range, chart.log_y, "y");
  for (const ChartSeries& series : chart.series) {
    const std::size_t count = series.y.size();
    const bool edges = series.step && series.x.size() == count + 1;
    if (series.x.size() != count && !edges) {
      throw InvalidInput(fmt::format("chart: series '{}' has {} x and {} y, expected as many",
                                     series.label, series.x.size(), count));
    }
    const bool band = !series.lower.empty() || !series.upper.empty();
    if (band && (series.lower.size() != count || series.upper.size() != count || edges)) {
      throw InvalidInput(
          fmt::format("chart: the band of series '{}' has {} and {} entries for {} "
                      "points, expected one per point",
                      series.label, series.lower.size(), series.upper.size(), count));
    }
  }
}

/// What stands above the panels.
struct ChartHead {
  std::string_view title;
  std::string_view note = {};

  double height() const {
    return (title.empty() ? kMargin : kTitleHeight) + (note.empty() ? 0.0 : kNoteHeight);
  }
};

void draw_head(SvgDocument& svg, const ChartHead& head, double width) {
  const double room = width - 2 * kMargin;
  if (!head.title.empty()) {
    svg.text({kMargin, 24}, head.title,
             {.size = fitting_size(kTitleSize, head.title, room), .bold = true});
  }
  if (head.note.empty()) return;
  svg.text({kMargin, head.height() - 10.0}, head.note,
           {.size = fitting_size(kNoteSize, head.note, room), .fill = std::string(kAxisColour)});
}

/// Panels in rows and columns below the head and the legend.
std::string draw_panels(const ChartHead& head, std::span<const Chart> charts, std::size_t columns,
                        double width, double panel_height) {
  for (const Chart& chart : charts) check(chart);
  const ChartLegend legend(charts);
  const double top = head.height() + legend.height(width - 2 * kMargin);
  const std::size_t rows = (charts.size() + columns - 1) / columns;
  SvgDocument svg(width, top + panel_height * static_cast<double>(rows), head.title);
  draw_head(svg, head, width);
  legend.draw(svg, {kMargin, top - legend.height(width - 2 * kMargin), width - 2 * kMargin, 0});
  const double panel_width = width / static_cast<double>(columns);
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const std::size_t row = i / columns;
    const std::size_t column = i % columns;
    const SvgBox box{panel_width * static_cast<double>(column),
                     top + panel_height * static_cast<double>(row), panel_width, panel_height};
    draw_panel(svg, box, charts[i], legend);
  }
  return svg.str();
}

}  // namespace

std::string draw_chart(const Chart& chart) {
  Chart panel = chart;
  panel.title.clear();
  return draw_panels({chart.title}, {&panel, 1}, 1, kWidth, kHeight);
}

std::string draw_charts(std::string_view title, std::span<const Chart> charts, int columns,
                        std::string_view note) {
  if (columns < 1)
    throw InvalidInput(fmt::format("charts: got {} columns, expected at least one", columns));
  require(!charts.empty(), "charts: got none, expected at least one");
  return draw_panels({title, note}, charts, static_cast<std::size_t>(columns),
                     std::max(kWidth, kLeastPanelWidth * columns), kPanelHeight);
}

}  // namespace posemix
