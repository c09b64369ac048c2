// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "chart_series.hpp"

#include <cstddef>
#include <utility>

namespace posemix::internal {
namespace {

constexpr double kLineWidth = 1.8;
constexpr double kDotWidth = 5.0;
constexpr double kBandOpacity = 0.16;

using Points = std::vector<Eigen::Vector2d>;

/// Collects points into pieces without gaps.
class Pieces {
 public:
  void add(const Eigen::Vector2d& point) { pieces_.back().push_back(point); }
  void gap() {
    if (!pieces_.back().empty()) pieces_.emplace_back();
  }
  std::vector<Points> take() { return std::move(pieces_); }

 private:
  std::vector<Points> pieces_ = std::vector<Points>(1);
};

std::vector<Points> line_pieces(const ChartAxis& x, const ChartAxis& y, const ChartSeries& series) {
  Pieces pieces;
  for (std::size_t i = 0; i < series.y.size(); ++i) {
    if (shows(series.x[i], x.log()) && shows(series.y[i], y.log())) {
      pieces.add({x.at(series.x[i]), y.at(series.y[i])});
    } else {
      pieces.gap();
    }
  }
  return pieces.take();
}

/// The outline of a staircase. The outline of a histogram has sides down to zero.
std::vector<Points> step_pieces(const ChartAxis& x, const ChartAxis& y, const ChartSeries& series) {
  const bool edges = series.x.size() > series.y.size();
  const double ground = y.log() ? y.range().first : 0.0;
  Pieces pieces;
  bool open = false;
  const auto close = [&](double at) {
    if (open && edges) pieces.add({at, y.at(ground)});
    pieces.gap();
    open = false;
  };
  for (std::size_t i = 0; i < series.y.size(); ++i) {
    if (!shows(series.x[i], x.log())) {
      pieces.gap();
      open = false;
      continue;
    }
    const double left = x.at(series.x[i]);
    if (!shows(series.y[i], y.log())) {
      close(left);
      continue;
    }
    if (!open && edges) pieces.add({left, y.at(ground)});
    open = true;
    const double level = y.at(series.y[i]);
    pieces.add({left, level});
    if (i + 1 < series.x.size() && shows(series.x[i + 1], x.log()))
      pieces.add({x.at(series.x[i + 1]), level});
  }
  if (edges && shows(series.x.back(), x.log())) close(x.at(series.x.back()));
  return pieces.take();
}

void draw_band(SvgDocument& svg, const ChartAxis& x, const ChartAxis& y, const ChartSeries& series,
               const std::string& colour) {
  Points outline;
  Points back;
  const auto draw = [&] {
    outline.insert(outline.end(), back.rbegin(), back.rend());
    svg.polygon(outline, {.fill = colour, .opacity = kBandOpacity});
    outline.clear();
    back.clear();
  };
  for (std::size_t i = 0; i < series.lower.size(); ++i) {
    const bool shown = shows(series.x[i], x.log()) && shows(series.lower[i], y.log()) &&
                       shows(series.upper[i], y.log());
    if (!shown) {
      draw();
      continue;
    }
    outline.emplace_back(x.at(series.x[i]), y.at(series.upper[i]));
    back.emplace_back(x.at(series.x[i]), y.at(series.lower[i]));
  }
  draw();
}

void draw_bars(SvgDocument& svg, const ChartAxis& x, const ChartAxis& y, const ChartSeries& series,
               const std::string& colour) {
  constexpr double kHalfCap = 3.0;
  const SvgStyle style{.stroke = colour, .width = 1.2};
  for (std::size_t i = 0; i < series.lower.size(); ++i) {
    const bool shown = shows(series.x[i], x.log()) && shows(series.lower[i], y.log()) &&
                       shows(series.upper[i], y.log());
    if (!shown) continue;
    const Eigen::Vector2d low(x.at(series.x[i]), y.at(series.lower[i]));
    const Eigen::Vector2d high(low.x(), y.at(series.upper[i]));
    const Eigen::Vector2d cap(kHalfCap, 0.0);
    svg.line(low, high, style);
    svg.line(low - cap, low + cap, style);
    svg.line(high - cap, high + cap, style);
  }
}

Points dots_of(const ChartAxis& x, const ChartAxis& y, const ChartSeries& series) {
  Points points;
  for (const Points& piece : line_pieces(x, y, series)) {
    if (series.markers || piece.size() == 1)
      points.insert(points.end(), piece.begin(), piece.end());
  }
  return points;
}

}  // namespace

void draw_series(SvgDocument& svg, const ChartAxis& x, const ChartAxis& y,
                 const ChartSeries& series, const SeriesStyle& style) {
  if (series.bars) {
    draw_bars(svg, x, y, series, style.colour);
  } else {
    draw_band(svg, x, y, series, style.colour);
  }
  const auto pieces = series.step ? step_pieces(x, y, series) : line_pieces(x, y, series);
  for (const Points& piece : pieces)
    svg.polyline(piece, {.stroke = style.colour, .width = kLineWidth, .dash = style.dash});
  if (!series.step) svg.dots(dots_of(x, y, series), {.stroke = style.colour, .width = kDotWidth});
}

}  // namespace posemix::internal
