// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/draw/chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

/// True if every tag is closed in order and no text has unescaped markup or numbers that are not
/// finite.
bool is_well_formed(const std::string& svg) {
  static const std::regex tag(
      R"re(<(/?)([A-Za-z]+)((?: [A-Za-z][A-Za-z0-9-]*="[^"<&]*")*) ?(/?)>)re");
  std::vector<std::string> open;
  std::string texts;
  auto end = svg.cbegin();
  for (std::sregex_iterator it(svg.begin(), svg.end(), tag), none; it != none; ++it) {
    texts.append(end, (*it)[0].first);
    end = (*it)[0].second;
    if ((*it)[1].length() > 0) {
      if (open.empty() || open.back() != (*it)[2]) return false;
      open.pop_back();
    } else if ((*it)[4].length() == 0) {
      open.push_back((*it)[2]);
    }
    const std::string attributes = (*it)[3];
    if (attributes.find("nan") != std::string::npos || attributes.find("inf") != std::string::npos)
      return false;
  }
  texts.append(end, svg.cend());
  return open.empty() && texts.find('<') == std::string::npos;
}

/// The labels of the axes: texts of 11.5 pixels.
std::vector<std::string> tick_labels(const std::string& svg) {
  static const std::regex label(R"re(font-size="11.5"[^>]*>([^<]*)</text>)re");
  std::vector<std::string> labels;
  for (std::sregex_iterator it(svg.begin(), svg.end(), label), none; it != none; ++it)
    labels.push_back((*it)[1]);
  return labels;
}

bool has_label(const std::string& svg, const std::string& label) {
  const auto labels = tick_labels(svg);
  return std::find(labels.begin(), labels.end(), label) != labels.end();
}

Chart sample() {
  Chart chart{.title = "KL & ISD <of> \"merges\"", .x_label = "phi [deg]", .y_label = "KL"};
  chart.series.push_back({.label = "midway", .x = {0, 1, 2, 3}, .y = {0.1, 0.2, 0.15, 0.4}});
  chart.series.push_back({.label = "larger",
                          .x = {0, 1, 2, 3},
                          .y = {0.2, 0.3, 0.25, 0.9},
                          .lower = {0.1, 0.2, 0.2, 0.7},
                          .upper = {0.3, 0.4, 0.3, 1.1},
                          .markers = true});
  chart.marks.emplace_back(0.5, "reference");
  return chart;
}

TEST(Chart, IsWellFormedAndNamesEverything) {
  const std::string svg = draw_chart(sample());
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_NE(svg.find("width=\"720\""), std::string::npos);
  for (const char* text :
       {"KL &amp; ISD &lt;of&gt;", ">phi [deg]<", ">midway<", ">larger<", ">reference<"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  EXPECT_EQ(count(svg, "<polyline"), 2U);
  EXPECT_EQ(count(svg, "<polygon"), 1U);
}

TEST(Chart, EqualChartsGiveEqualTexts) { EXPECT_EQ(draw_chart(sample()), draw_chart(sample())); }

TEST(Chart, LinearTicksAreRoundAndCoverTheRange) {
  Chart chart;
  chart.series.push_back({.label = "a", .x = {0, 60}, .y = {0, 0.31}});
  const std::string svg = draw_chart(chart);
  for (const char* label : {"0", "10", "60", "0.1", "0.3"}) EXPECT_TRUE(has_label(svg, label));
  EXPECT_FALSE(has_label(svg, "0.30000000000000004"));
}

TEST(Chart, SmallPanelsHaveThreeTicksAtLeast) {
  for (const double reach : {0.03, 0.4, 1.0, 2.4, 4.9, 7.0}) {
    Chart chart{.x_range = std::pair(-reach, reach), .y_range = std::pair(1.0, 2.0)};
    chart.series.push_back({.x = {-reach, reach}, .y = {1, 2}});
    const std::string svg = draw_charts("panels", std::vector<Chart>{chart, chart, chart}, 3);
    const std::vector<std::string> labels = tick_labels(svg);
    // Numbers beyond 0.9 are of y.
    std::set<std::string> of_x;
    for (const std::string& label : labels) {
      if (std::abs(std::stod(label)) <= reach && !(std::stod(label) >= 1.0 && reach < 1.0))
        of_x.insert(label);
    }
    EXPECT_GE(of_x.size(), 3U) << reach;
  }
}

TEST(Chart, TicksWhereTheDataAre) {
  Chart chart{.x_ticks = {0, 1, 2, 3, 4, 5, 9}};
  chart.series.push_back({.x = {0, 5}, .y = {10, 20}});
  const std::string svg = draw_chart(chart);
  for (const char* label : {"0", "1", "2", "3", "4", "5"}) EXPECT_TRUE(has_label(svg, label));
  EXPECT_FALSE(has_label(svg, "9")) << "beyond the range";
}

TEST(Chart, EqualAxesKeepACircleRound) {
  Chart chart{.equal_axes = true};
  ChartSeries circle;
  for (int i = 0; i <= 90; ++i) {
    circle.x.push_back(3.0 * std::cos(4.0 * i * M_PI / 180.0));
    circle.y.push_back(3.0 * std::sin(4.0 * i * M_PI / 180.0));
  }
  chart.series.push_back(circle);
  const auto extent = [](const std::string& svg) {
    std::smatch found;
    EXPECT_TRUE(std::regex_search(svg, found, std::regex(R"re(<polyline points="([^"]*)")re")));
    double x[2] = {1e9, -1e9};
    double y[2] = {1e9, -1e9};
    std::istringstream numbers(found[1]);
    for (std::string pair; numbers >> pair;) {
      const double at_x = std::stod(pair);
      const double at_y = std::stod(pair.substr(pair.find(',') + 1));
      x[0] = std::min(x[0], at_x), x[1] = std::max(x[1], at_x);
      y[0] = std::min(y[0], at_y), y[1] = std::max(y[1], at_y);
    }
    return (x[1] - x[0]) / (y[1] - y[0]);
  };
  EXPECT_NEAR(extent(draw_chart(chart)), 1.0, 0.01);
  chart.equal_axes = false;
  EXPECT_GT(extent(draw_chart(chart)), 1.3);
}

TEST(Chart, ErrorBarsAndANote) {
  Chart chart = sample();
  const std::string band = draw_chart(chart);
  chart.series[1].bars = true;
  const std::string bars = draw_chart(chart);
  EXPECT_EQ(count(bars, "<polygon"), 0U);
  EXPECT_EQ(count(bars, "<line") - count(band, "<line"), 12U) << "a bar and two caps a point";
  const std::string noted = draw_charts("title", {&chart, 1}, 1, "a < b is said here");
  EXPECT_NE(noted.find(">a &lt; b is said here<"), std::string::npos);
  EXPECT_TRUE(is_well_formed(noted));
}

TEST(Chart, TicksOfANarrowRangeFarFromZeroDiffer) {
  Chart chart;
  chart.series.push_back({.label = "a", .x = {0, 1}, .y = {1234567.0, 1234567.4}});
  EXPECT_TRUE(has_label(draw_chart(chart), "1234567.1"));
}

TEST(Chart, LogTicksAreDecades) {
  Chart chart{.log_x = true, .log_y = true};
  chart.series.push_back({.label = "a", .x = {1, 1e5}, .y = {2e-7, 30}});
  const std::string svg = draw_chart(chart);
  for (const char* label : {"1", "100", "10000", "1e-6", "0.01"})
    EXPECT_TRUE(has_label(svg, label)) << label;
  EXPECT_FALSE(has_label(svg, "2"));
}

TEST(Chart, LogTicksOfAShortRangeAreStillReadable) {
  Chart chart{.log_y = true};
  chart.series.push_back({.label = "a", .x = {0, 1}, .y = {8.1, 9.9}});
  EXPECT_TRUE(has_label(draw_chart(chart), "9"));
  chart.series[0].y = {3, 80};
  const std::string svg = draw_chart(chart);
  for (const char* label : {"5", "10", "20", "50"}) EXPECT_TRUE(has_label(svg, label)) << label;
}

TEST(Chart, PointsThatAreNotFiniteBreakTheLine) {
  Chart chart;
  chart.series.push_back({.x = {0, 1, 2, 3, 4, 5}, .y = {1, 2, kNan, 2, 3, 4}});
  EXPECT_EQ(count(draw_chart(chart), "<polyline"), 2U);
  chart.series[0].y = {1, 2, kNan, 2, kNan, INFINITY};
  const std::string svg = draw_chart(chart);
  EXPECT_EQ(count(svg, "<polyline"), 1U);
  EXPECT_EQ(count(svg, "<path d="), 1U);
  EXPECT_TRUE(is_well_formed(svg));
}

TEST(Chart, LogAxesLeaveOutWhatIsNotPositive) {
  Chart with{.log_y = true};
  with.series.push_back({.x = {0, 1, 2, 3, 4}, .y = {1, 10, 0, 10, 1}});
  Chart without{.log_y = true};
  without.series.push_back({.x = {0, 1, 2, 3, 4}, .y = {1, 10, kNan, 10, 1}});
  EXPECT_EQ(draw_chart(with), draw_chart(without));
  with.series[0].y[2] = -5;
  EXPECT_EQ(draw_chart(with), draw_chart(without));
  with.marks.emplace_back(-1.0, "below");
  EXPECT_EQ(draw_chart(with), draw_chart(without));
}

TEST(Chart, EmptyConstantAndExtremeSeriesAreDrawn) {
  for (const bool log : {false, true}) {
    Chart chart{.log_x = log, .log_y = log};
    EXPECT_TRUE(is_well_formed(draw_chart(chart)));
    chart.series.push_back({.label = "empty"});
    EXPECT_TRUE(is_well_formed(draw_chart(chart)));
    for (const double value : {0.0, 3.0, -2.0, 1e300, -1e300, 1e-300, 1e308, 5e-324}) {
      chart.series.push_back({.label = "value", .x = {1, 2}, .y = {value, value}});
      EXPECT_TRUE(is_well_formed(draw_chart(chart))) << value;
    }
  }
  Chart constant;
  constant.series.push_back({.x = {1, 2}, .y = {3, 3}});
  EXPECT_TRUE(has_label(draw_chart(constant), "3"));
}

TEST(Chart, StepsAndHistogramOutlines) {
  Chart chart{.x_range = std::pair(0.0, 2.0), .y_range = std::pair(0.0, 1.0)};
  chart.series.push_back({.x = {0, 1, 2}, .y = {1, 0.5, 0.5}, .step = true});
  const std::regex points(R"re(<polyline points="([^"]*)")re");
  std::smatch found;
  std::string svg = draw_chart(chart);
  ASSERT_TRUE(std::regex_search(svg, found, points));
  const std::string stairs = found[1];
  EXPECT_EQ(count(stairs, ","), 5U);
  chart.series[0].y = {1, 0.5};
  svg = draw_chart(chart);
  ASSERT_TRUE(std::regex_search(svg, found, points));
  EXPECT_EQ(count(found[1], ","), 6U);
  const std::string outline = found[1];
  const std::string ground = outline.substr(outline.rfind(','));
  EXPECT_EQ(outline.substr(outline.find(','), ground.size()), ground);
}

TEST(Chart, SmallMultiplesShareTheLegendAndItsColours) {
  std::vector<Chart> charts(3, sample());
  charts[1].series.erase(charts[1].series.begin());
  const std::string svg = draw_charts("three", charts, 2);
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(count(svg, ">larger<"), 1U);
  EXPECT_EQ(count(svg, "<polyline"), 5U);
  EXPECT_EQ(count(svg, "<polygon points"), 3U);
  const std::regex band(R"re(<polygon points="[^"]*" fill="([^"]*)")re");
  std::set<std::string> colours;
  for (std::sregex_iterator it(svg.begin(), svg.end(), band), none; it != none; ++it)
    colours.insert((*it)[1]);
  EXPECT_EQ(colours.size(), 1U);
}

TEST(Chart, ManySeriesAllLookDifferent) {
  Chart chart;
  for (int i = 0; i < 12; ++i)
    chart.series.push_back({.label = "s" + std::to_string(i), .x = {0, 1}, .y = {0, 1.0 * i}});
  const std::string svg = draw_chart(chart);
  const std::regex line(R"re(<polyline points="[^"]*"([^>]*)>)re");
  std::set<std::string> styles;
  for (std::sregex_iterator it(svg.begin(), svg.end(), line), none; it != none; ++it)
    styles.insert((*it)[1]);
  EXPECT_EQ(styles.size(), 12U);
}

TEST(Chart, RefusesWhatDoesNotFit) {
  Chart chart;
  chart.series.push_back({.label = "a", .x = {1, 2}, .y = {1}});
  EXPECT_THROW(draw_chart(chart), InvalidInput);
  chart.series[0] = {.label = "a", .x = {1}, .y = {1}, .lower = {1}};
  EXPECT_THROW(draw_chart(chart), InvalidInput);
  chart.series.clear();
  chart.y_range = std::pair(2.0, 1.0);
  EXPECT_THROW(draw_chart(chart), InvalidInput);
  chart.y_range = std::pair(0.0, 1.0);
  EXPECT_NO_THROW(draw_chart(chart));
  chart.log_y = true;
  EXPECT_THROW(draw_chart(chart), InvalidInput);
  EXPECT_THROW(draw_charts("none", {}, 2), InvalidInput);
  EXPECT_THROW(draw_charts("none", std::vector<Chart>(1), 0), InvalidInput);
}

}  // namespace
}  // namespace posemix
