// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "chart_panel.hpp"

#include <algorithm>
#include <limits>
#include <string_view>

#include "chart_axis.hpp"
#include "chart_series.hpp"
#include "picture_colours.hpp"

namespace posemix::internal {
namespace {

constexpr std::string_view kChartFineGrid = "#F3F3F3";

constexpr double kLeft = 60.0;
constexpr double kRight = 16.0;
constexpr double kBottom = 46.0;
constexpr double kLabelHeight = 20.0;
constexpr double kPanelTitleHeight = 20.0;
constexpr double kTickFont = 11.5;
constexpr double kLabelFont = 12.5;
constexpr double kPixelsPerXTick = 60.0;
constexpr double kPixelsPerYTick = 45.0;

void append(std::vector<double>& values, const std::vector<double>& more) {
  values.insert(values.end(), more.begin(), more.end());
}

ChartRange x_range(const Chart& chart) {
  if (chart.x_range) return *chart.x_range;
  std::vector<double> values;
  for (const ChartSeries& series : chart.series) append(values, series.x);
  return range_around(values, chart.log_x);
}

ChartRange y_range(const Chart& chart) {
  if (chart.y_range) return *chart.y_range;
  std::vector<double> values;
  for (const ChartSeries& series : chart.series) {
    append(values, series.y);
    append(values, series.lower);
    append(values, series.upper);
    if (series.step && series.x.size() > series.y.size()) values.push_back(0.0);
  }
  for (const auto& mark : chart.marks) values.push_back(mark.first);
  return range_around(values, chart.log_y);
}

SvgStyle grid_style(const ChartTick& tick) {
  return {.stroke = std::string(tick.label.empty() ? kChartFineGrid : kGridColour)};
}

SvgFont tick_font(SvgAnchor anchor) {
  return {.size = kTickFont, .fill = std::string(kAxisColour), .anchor = anchor};
}

int tick_count(double pixels, double pixels_per_tick) {
  return std::max(3, static_cast<int>(pixels / pixels_per_tick));
}

/// Widens the range of one axis about its centre, so that a unit has as many pixels on both.
void make_equal(ChartRange& x, ChartRange& y, const SvgBox& plot) {
  const auto widen = [](ChartRange& range, double length) {
    const double centre = 0.5 * (range.first + range.second);
    range = {centre - 0.5 * length, centre + 0.5 * length};
  };
  const double unit =
      std::max((x.second - x.first) / plot.width, (y.second - y.first) / plot.height);
  widen(x, unit * plot.width);
  widen(y, unit * plot.height);
}

void draw_grid(SvgDocument& svg, const SvgBox& plot, const ChartAxis& x, const ChartAxis& y,
               const Chart& chart) {
  const auto x_ticks = chart.x_ticks.empty() ? x.ticks(tick_count(plot.width, kPixelsPerXTick))
                                             : x.ticks_at(chart.x_ticks);
  for (const ChartTick& tick : x_ticks) {
    const double at = x.at(tick.value);
    svg.line({at, plot.top}, {at, plot.bottom()}, grid_style(tick));
    if (!tick.label.empty())
      svg.text({at, plot.bottom() + 15}, tick.label, tick_font(SvgAnchor::middle));
  }
  for (const ChartTick& tick : y.ticks(tick_count(plot.height, kPixelsPerYTick))) {
    const double at = y.at(tick.value);
    svg.line({plot.left, at}, {plot.right(), at}, grid_style(tick));
    if (!tick.label.empty())
      svg.text({plot.left - 6, at + 4}, tick.label, tick_font(SvgAnchor::end));
  }
}

void draw_labels(SvgDocument& svg, const SvgBox& box, const SvgBox& plot, const Chart& chart) {
  const SvgFont font{.size = kLabelFont, .fill = std::string(kAxisColour)};
  if (!chart.title.empty())
    svg.text({plot.left, box.top + 15}, chart.title, {.size = 13.5, .bold = true});
  svg.text({box.left + 14, plot.top - 7}, chart.y_label, font);
  svg.text({plot.right(), plot.bottom() + 34}, chart.x_label,
           {.size = kLabelFont, .fill = std::string(kAxisColour), .anchor = SvgAnchor::end});
}

void draw_marks(SvgDocument& svg, const SvgBox& plot, const ChartAxis& y, const Chart& chart) {
  for (const auto& [value, label] : chart.marks) {
    if (!shows(value, y.log()) || value < y.range().first || value > y.range().second) continue;
    const double at = y.at(value);
    svg.line({plot.left, at}, {plot.right(), at},
             {.stroke = std::string(kAxisColour), .width = 1.2, .dash = "5 4"});
    svg.text({plot.right() - 5, at - 4}, label,
             {.size = kTickFont,
              .fill = std::string(kAxisColour),
              .anchor = SvgAnchor::end,
              .halo = true});
  }
}

}  // namespace

void draw_panel(SvgDocument& svg, const SvgBox& box, const Chart& chart,
                const ChartLegend& legend) {
  const double head = (chart.title.empty() ? 0.0 : kPanelTitleHeight) + kLabelHeight;
  const SvgBox plot{box.left + kLeft, box.top + head, box.width - kLeft - kRight,
                    box.height - head - kBottom};
  ChartRange range_of_x = x_range(chart);
  ChartRange range_of_y = y_range(chart);
  if (chart.equal_axes) make_equal(range_of_x, range_of_y, plot);
  const ChartAxis x(range_of_x, chart.log_x, plot.left, plot.right());
  const ChartAxis y(range_of_y, chart.log_y, plot.bottom(), plot.top);
  draw_grid(svg, plot, x, y, chart);
  svg.begin_clip(plot);
  for (const ChartSeries& series : chart.series)
    draw_series(svg, x, y, series, legend.style(series));
  svg.end_clip();
  draw_marks(svg, plot, y, chart);
  svg.rectangle(plot, {.stroke = std::string(kAxisColour), .width = 0.8});
  draw_labels(svg, box, plot, chart);
}

}  // namespace posemix::internal
