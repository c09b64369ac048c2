// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "chart_legend.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "picture_colours.hpp"

namespace posemix::internal {
namespace {

constexpr double kFontSize = 12.5;
constexpr double kRowHeight = 19.0;
constexpr double kSwatch = 26.0;
constexpr double kGap = 7.0;
constexpr double kBelow = 8.0;

/// A second round through the colours is dashed, a third dotted.
constexpr std::array<std::string_view, 3> kDashes{"", "7 4", "2 3"};

SeriesStyle numbered_style(std::size_t number) {
  return {object_colour(number),
          std::string(kDashes[number / kObjectColours.size() % kDashes.size()])};
}

double entry_width(const std::string& label) {
  return kSwatch + 5 * kGap + kCharacterWidth * kFontSize * static_cast<double>(label.size());
}

}  // namespace

ChartLegend::ChartLegend(std::span<const Chart> charts) {
  for (const Chart& chart : charts) {
    for (const ChartSeries& series : chart.series) {
      const auto same = [&](const Entry& entry) { return entry.label == series.label; };
      if (series.label.empty() || std::any_of(entries_.begin(), entries_.end(), same)) continue;
      SeriesStyle style = numbered_style(entries_.size());
      if (!series.color.empty()) style = {series.color, ""};
      if (!series.dash.empty()) style.dash = series.dash;
      style.markers = series.markers;
      entries_.push_back({series.label, std::move(style)});
    }
  }
}

SeriesStyle ChartLegend::style(const ChartSeries& series) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.label == series.label; });
  SeriesStyle style = found == entries_.end() ? numbered_style(0) : found->style;
  if (!series.color.empty()) style = {series.color, ""};
  if (!series.dash.empty()) style.dash = series.dash;
  style.markers = series.markers;
  return style;
}

double ChartLegend::height(double width) const {
  if (entries_.empty()) return 0.0;
  double rows = 1.0;
  double right = 0.0;
  for (const Entry& entry : entries_) {
    const double next = entry_width(entry.label);
    if (right > 0.0 && right + next > width) {
      ++rows;
      right = 0.0;
    }
    right += next;
  }
  return rows * kRowHeight + kBelow;
}

void ChartLegend::draw(SvgDocument& svg, const SvgBox& box) const {
  double left = 0.0;
  double y = box.top + 0.5 * kRowHeight;
  for (const Entry& entry : entries_) {
    const double next = entry_width(entry.label);
    if (left > 0.0 && left + next > box.width) {
      y += kRowHeight;
      left = 0.0;
    }
    const double x = box.left + left;
    svg.line({x, y}, {x + kSwatch, y},
             {.stroke = entry.style.colour, .width = 2.4, .dash = entry.style.dash});
    if (entry.style.markers) svg.circle({x + 0.5 * kSwatch, y}, 3.2, {.fill = entry.style.colour});
    svg.text({x + kSwatch + kGap, y + 4}, entry.label, {.size = kFontSize});
    left += next;
  }
}

}  // namespace posemix::internal
