// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "chart_axis.hpp"
#include "chart_legend.hpp"
#include "posemix/draw/chart.hpp"
#include "svg.hpp"

namespace posemix::internal {

/// Draws the lines, bands and dots of a series.
void draw_series(SvgDocument& svg, const ChartAxis& x, const ChartAxis& y,
                 const ChartSeries& series, const SeriesStyle& style);

}  // namespace posemix::internal
