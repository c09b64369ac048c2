// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chart_axis.hpp"
#include "posemix/draw/chart.hpp"
#include "svg.hpp"

/// The parts of a chart.
namespace posemix {

/// Mean width of a character in shares of the font's size.
inline constexpr double kCharacterWidth = 0.55;

inline constexpr std::string_view kChartGrid = "#E4E4E4";
inline constexpr std::string_view kChartFineGrid = "#F3F3F3";
inline constexpr std::string_view kChartAxis = "#555555";

/// Colour and dash of a series: its own, or the defaults for its place in the legend.
struct SeriesStyle {
  std::string colour;
  std::string dash;
  bool markers = false;
};

/// The labels of all series of some charts, each once.
class ChartLegend {
 public:
  explicit ChartLegend(std::span<const Chart> charts);

  SeriesStyle style(const ChartSeries& series) const;
  double height(double width) const;
  void draw(SvgDocument& svg, const SvgBox& box) const;

 private:
  struct Entry {
    std::string label;
    SeriesStyle style;
  };
  std::vector<Entry> entries_;
};

/// A chart with its axes and title in a box.
void draw_panel(SvgDocument& svg, const SvgBox& box, const Chart& chart, const ChartLegend& legend);

/// The lines, bands and dots of a series.
void draw_series(SvgDocument& svg, const ChartAxis& x, const ChartAxis& y,
                 const ChartSeries& series, const SeriesStyle& style);

}  // namespace posemix
