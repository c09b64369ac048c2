// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "svg.hpp"

#include <cmath>

#include <fmt/format.h>

namespace posemix::internal {
namespace {

std::string attributes(const SvgStyle& style) {
  std::string text = fmt::format(R"( fill="{}")", style.fill);
  if (style.stroke != "none") {
    text += fmt::format(R"( stroke="{}" stroke-width="{:.4g}" stroke-linejoin="round")",
                        style.stroke, style.width);
  }
  if (style.opacity < 1.0) text += fmt::format(R"( opacity="{:.3g}")", style.opacity);
  if (!style.dash.empty()) text += fmt::format(R"( stroke-dasharray="{}")", style.dash);
  return text;
}

std::string pairs(std::span<const Eigen::Vector2d> points) {
  std::string text;
  for (const Eigen::Vector2d& point : points) {
    text += fmt::format("{}{:.1f},{:.1f}", text.empty() ? "" : " ", point.x(), point.y());
  }
  return text;
}

std::string_view word(SvgAnchor anchor) {
  switch (anchor) {
    case SvgAnchor::start:
      return "start";
    case SvgAnchor::middle:
      return "middle";
    case SvgAnchor::end:
      return "end";
  }
  return "start";
}

std::string font_extras(const SvgFont& font) {
  std::string text = font.bold ? R"( font-weight="bold")" : "";
  if (font.halo) text += R"( stroke="#ffffff" stroke-width="3" paint-order="stroke")";
  return text;
}

}  // namespace

std::string xml_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c >= ' ' && c <= '~' ? c : '?';
    }
  }
  return result;
}

SvgDocument::SvgDocument(double width, double height, std::string_view title)
    : body_(fmt::format(
          R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0:.0f}" height="{1:.0f}" viewBox="0 0 {0:.0f} {1:.0f}" )"
          R"(font-family="Helvetica, Arial, 'DejaVu Sans', sans-serif">)"
          "\n<title>{2}</title>\n",
          width, height, xml_text(title))) {
  rectangle({0, 0, width, height}, {.fill = "#ffffff"});
}

void SvgDocument::rectangle(const SvgBox& box, const SvgStyle& style) {
  body_ += fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"{}/>)",
                       box.left, box.top, box.width, box.height, attributes(style)) +
           "\n";
}

void SvgDocument::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                       const SvgStyle& style) {
  body_ += fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}"{}/>)", from.x(),
                       from.y(), to.x(), to.y(), attributes(style)) +
           "\n";
}

void SvgDocument::polyline(std::span<const Eigen::Vector2d> points, const SvgStyle& style) {
  if (points.size() < 2) return;
  body_ += fmt::format(R"(<polyline points="{}"{}/>)", pairs(points), attributes(style)) + "\n";
}

void SvgDocument::polygon(std::span<const Eigen::Vector2d> points, const SvgStyle& style) {
  if (points.size() < 3) return;
  body_ += fmt::format(R"(<polygon points="{}"{}/>)", pairs(points), attributes(style)) + "\n";
}

void SvgDocument::dots(std::span<const Eigen::Vector2d> points, const SvgStyle& style) {
  if (points.empty()) return;
  std::string path;
  for (const Eigen::Vector2d& point : points)
    path += fmt::format("M{:.1f} {:.1f}h0", point.x(), point.y());
  body_ +=
      fmt::format(R"(<path d="{}" stroke-linecap="round"{}/>)", path, attributes(style)) + "\n";
}

void SvgDocument::circle(const Eigen::Vector2d& centre, double radius, const SvgStyle& style) {
  body_ += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}"{}/>)", centre.x(), centre.y(),
                       radius, attributes(style)) +
           "\n";
}

void SvgDocument::ellipse(const Eigen::Vector2d& centre, const Eigen::Vector2d& radii,
                          double rotation_deg, const SvgStyle& style) {
  body_ +=
      fmt::format(
          R"x(<ellipse rx="{:.2f}" ry="{:.2f}" transform="translate({:.1f} {:.1f}) rotate({:.2f})"{}/>)x",
          radii.x(), radii.y(), centre.x(), centre.y(), rotation_deg, attributes(style)) +
      "\n";
}

void SvgDocument::text(const Eigen::Vector2d& at, std::string_view text, const SvgFont& font) {
  body_ +=
      fmt::format(
          R"(<text x="{:.1f}" y="{:.1f}" font-size="{:.4g}" fill="{}" text-anchor="{}"{}>{}</text>)",
          at.x(), at.y(), font.size, font.fill, word(font.anchor), font_extras(font),
          xml_text(text)) +
      "\n";
}

void SvgDocument::begin_clip(const SvgBox& box) {
  body_ +=
      fmt::format(
          R"(<clipPath id="clip{0}"><rect x="{1:.1f}" y="{2:.1f}" width="{3:.1f}" height="{4:.1f}"/>)"
          R"x(</clipPath><g clip-path="url(#clip{0})">)x",
          clips_++, box.left, box.top, box.width, box.height) +
      "\n";
}

void SvgDocument::end_clip() { body_ += "</g>\n"; }

double round_step(double extent, int count) {
  const double rough = extent / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace posemix::internal
