// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "chart_legend.hpp"
#include "posemix/draw/chart.hpp"
#include "svg.hpp"

namespace posemix::internal {

/// Draws a chart with its axes and title in a box.
void draw_panel(SvgDocument& svg, const SvgBox& box, const Chart& chart, const ChartLegend& legend);

}  // namespace posemix::internal
