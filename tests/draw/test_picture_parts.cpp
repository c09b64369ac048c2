// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <regex>

#include <gtest/gtest.h>

#include "draw/method_colours.hpp"
#include "draw/picture_colours.hpp"
#include "draw/picture_labels.hpp"
#include "draw/picture_strip.hpp"
#include "draw/run_consistency.hpp"

/// The parts of picture.svg.
namespace posemix::internal {
namespace {

constexpr SvgBox kArea{0.0, 0.0, 560.0, 460.0};

bool share_area(const SvgBox& a, const SvgBox& b) {
  return a.left < b.right() && b.left < a.right() && a.top < b.bottom() && b.top < a.bottom();
}

double distance(const SvgBox& box, const Eigen::Vector2d& point) {
  const Eigen::Vector2d nearest(std::clamp(point.x(), box.left, box.right()),
                                std::clamp(point.y(), box.top, box.bottom()));
  return (point - nearest).norm();
}

/// Objects on a table, nearer to each other than their names are long.
std::vector<PointLabel> crowd() {
  std::vector<PointLabel> labels;
  for (int i = 0; i < 15; ++i) {
    labels.push_back({"object-" + std::to_string(i), "#222222",
                      Eigen::Vector2d(230.0 + 26.0 * (i % 5), 200.0 + 22.0 * (i / 5.0))});
  }
  return labels;
}

TEST(PictureLabels, DoNotOverlapAndStayInTheArea) {
  const std::vector<PointLabel> labels = crowd();
  const std::vector<PlacedLabel> placed = place_labels(labels, kArea, {});
  ASSERT_EQ(placed.size(), labels.size());
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const SvgBox& box = placed[i].box;
    EXPECT_GE(box.left, kArea.left);
    EXPECT_LE(box.right(), kArea.right());
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(share_area(box, placed[j].box)) << i << j;
    for (const PointLabel& label : labels)
      EXPECT_GT(distance(box, label.at), 2.0) << labels[i].text << " on " << label.text;
  }
}

TEST(PictureLabels, ALineLeadsFromALabelThatIsNotBesideItsPoint) {
  SvgDocument svg(600, 500, "labels");
  const std::vector<PointLabel> labels = crowd();
  draw_point_labels(svg, labels, kArea, {});
  const std::vector<PlacedLabel> placed = place_labels(labels, kArea, {});
  const std::string text = svg.str();
  std::size_t lines = 0;
  for (std::size_t at = text.find("<line"); at != std::string::npos;
       at = text.find("<line", at + 1))
    ++lines;
  std::size_t far = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_LT(distance(placed[i].box, placed[i].leader_end), 1.0);
    far += (placed[i].leader_end - labels[i].at).norm() > 9.0 ? 1 : 0;
  }
  EXPECT_EQ(lines, far);
  EXPECT_GT(far, 0U);
}

TEST(PictureLabels, AloneALabelIsBesideItsPoint) {
  const std::vector<PointLabel> one{{"mug", "#222222", {280.0, 230.0}}};
  const PlacedLabel placed = place_labels(one, kArea, {}).front();
  EXPECT_LT(distance(placed.box, one[0].at), 10.0);
}

std::vector<double> seconds(std::size_t count) {
  std::vector<double> stamps;
  for (std::size_t k = 0; k < count; ++k) stamps.push_back(static_cast<double>(k));
  return stamps;
}

std::string strip_of(const ErrorCurves& curves, std::size_t count) {
  SvgDocument svg(600, 100, "strip");
  draw_error_strip(svg, {50, 10, 500, 80}, seconds(count), curves, {"#296E79", "deg"});
  return svg.str();
}

TEST(PictureStrip, WhatIsBeyondTheScaleIsMarkedAndCounted) {
  ErrorCurves curves;
  for (std::size_t k = 0; k < 200; ++k) {
    const bool flipped = k == 20 || k == 100;
    curves.estimate.emplace_back(flipped ? 176.0
                                         : 1.0 + 0.2 * std::sin(0.3 * static_cast<double>(k)));
    curves.detector.emplace_back(k % 50 == 3 ? 90.0 : 1.5);
    curves.width.emplace_back(2.0);
  }
  const std::string svg = strip_of(curves, 200);
  EXPECT_NE(svg.find("beyond: 2 estimates (to 176 deg), 4 detections (to 90 deg)"),
            std::string::npos);
  const std::regex caret(R"re(<polygon points="[^ ]* [^ ]* [^ "]*")re");
  const auto found =
      std::distance(std::sregex_iterator(svg.begin(), svg.end(), caret), std::sregex_iterator());
  EXPECT_EQ(found, 6);
}

TEST(PictureStrip, NothingIsSaidWhereAllIsShown) {
  ErrorCurves curves;
  for (std::size_t k = 0; k < 50; ++k) {
    curves.estimate.emplace_back(1.0);
    curves.detector.emplace_back();
    curves.width.emplace_back(2.0);
  }
  EXPECT_EQ(strip_of(curves, 50).find("beyond"), std::string::npos);
}

TEST(PictureStrip, APeakOfALongRunIsDrawn) {
  ErrorCurves curves;
  for (std::size_t k = 0; k < 20000; ++k) {
    curves.estimate.emplace_back(k == 12345 ? 1.19 : 1.0);
    curves.detector.emplace_back();
    curves.width.emplace_back(0.1);
  }
  curves.estimate[3] = 1.19;
  const std::string svg = strip_of(curves, 20000);
  std::smatch line;
  ASSERT_TRUE(std::regex_search(svg, line, std::regex(R"re(<polyline points="([^"]*)")re")));
  const std::string points = line[1];
  const std::string peak = points.substr(points.find(','), points.find(' ') - points.find(','));
  EXPECT_NE(points.find(peak, 20), std::string::npos) << "the second peak is as high as the first";
}

TEST(RunConsistency, SaysWhereTheFaultIs) {
  ConsistencyReport report;
  const Coverage good{{0.68, 0.95, 0.997}, {0.683, 0.954, 0.9973}};
  report.axes = {{.axis = "rotation x", .coverage = good},
                 {.axis = "position x", .coverage = good}};
  report.axes[1].coverage.shares[2] = 0.84;
  EXPECT_EQ(fault_text(report), "") << "consistent";
  report.verdict = ConsistencyVerdict::overconfident;
  EXPECT_EQ(fault_text(report), "16 % of position x outside 3 sigma");
  report.axes[1].coverage = good;
  report.most_overconfident.name = "rotation z";
  EXPECT_EQ(fault_text(report), "most along rotation z");
  report.verdict = ConsistencyVerdict::cautious;
  report.most_cautious.name = "position y";
  EXPECT_EQ(fault_text(report), "most along position y");
}

TEST(MethodColours, AMethodHasItsColourAndVariantsADash) {
  EXPECT_EQ(method_series("midway").color, kObjectColours[1]);
  EXPECT_EQ(method_series("riekf").color, method_series("iterated_riekf").color);
  EXPECT_EQ(method_series("riekf").dash, "");
  EXPECT_NE(method_series("iterated_riekf").dash, "");
  EXPECT_EQ(method_series("of my own").color, "") << "that of its place in the legend";
}

}  // namespace
}  // namespace posemix::internal
