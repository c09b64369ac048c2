// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Line charts as SVG.
namespace posemix {

/// A line of a chart.
///
/// Points that are not finite (within 1e300), or not positive on a logarithmic axis (1e-300 at
/// least), are left out and break the line. A point without neighbours is drawn as a dot.
struct ChartSeries {
  std::string label = {};  ///< label in the legend; empty: no entry
  std::vector<double> x = {};
  std::vector<double> y = {};
  std::vector<double> lower =
      {};  ///< lower edges of a band, one per point, with `upper`; empty: no band
  std::vector<double> upper = {};
  bool bars = false;       ///< the band as an error bar on every point
  std::string color = {};  ///< as "#296E79"; empty: chosen by the label's place in the legend
  std::string dash = {};   ///< lengths of dashes and gaps, as "6 4"; empty: a full line
  bool markers = false;    ///< a dot on every point
  /// Steps: y[i] holds from x[i] to x[i+1]. With one x more than y, the edges of a histogram's
  /// bins, the outline is closed at y = 0.
  bool step = false;
};

/// A chart with one pair of axes. Texts are ASCII.
struct Chart {
  std::string title = {};
  std::string x_label = {};
  std::string y_label = {};
  bool log_x = false;
  bool log_y = false;
  std::vector<ChartSeries> series = {};
  std::optional<std::pair<double, double>> x_range = {};  ///< empty: the range of the series
  std::optional<std::pair<double, double>> y_range = {};
  std::vector<std::pair<double, std::string>> marks = {};  ///< horizontal reference lines
  std::vector<double> x_ticks = {};  ///< where the x axis has ticks; empty: at round numbers
  bool equal_axes = false;           ///< as many pixels for a unit of x as of y, both linear
};

/// One SVG document of 720 pixels in width. Equal charts give equal texts.
/// @throws InvalidInput when a series' vectors differ in length, or a range is not finite, empty,
/// or not positive on a logarithmic axis
std::string draw_chart(const Chart& chart);

/// Small multiples with one legend: charts row by row in `columns` columns, which share the colours
/// of equal labels. At least 720 pixels wide, 300 per column. `note` is a sentence below the title.
/// @throws InvalidInput as draw_chart, when there is no chart, or when `columns` is below one
std::string draw_charts(std::string_view title, std::span<const Chart> charts, int columns,
                        std::string_view note = {});

}  // namespace posemix
