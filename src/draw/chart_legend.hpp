// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <vector>

#include "posemix/draw/chart.hpp"
#include "svg.hpp"

namespace posemix::internal {

/// Mean width of a character in shares of the font's size.
inline constexpr double kCharacterWidth = 0.55;

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

}  // namespace posemix::internal
