// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

/// Writes SVG pictures as text. Coordinates are pixels, x to the right and y down.
namespace posemix::internal {

struct SvgStyle {
  std::string stroke = "none";
  double width = 1.0;
  std::string fill = "none";
  double opacity = 1.0;   ///< opacity of stroke and fill
  std::string dash = {};  ///< lengths of dashes and gaps, such as "6 4"
};

enum class SvgAnchor { start, middle, end };

struct SvgFont {
  double size = 13.0;
  std::string fill = "#222222";
  SvgAnchor anchor = SvgAnchor::start;
  bool bold = false;
  bool halo = false;  ///< a white rim, for text on top of a drawing
};

struct SvgBox {
  double left, top, width, height;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

/// A text as XML: markup escaped, control characters and bytes that are not ASCII replaced by '?'.
std::string xml_text(std::string_view text);

class SvgDocument {
 public:
  SvgDocument(double width, double height, std::string_view title);

  void rectangle(const SvgBox& box, const SvgStyle& style);
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const SvgStyle& style);
  /// A line through the points; draws nothing for fewer than two.
  void polyline(std::span<const Eigen::Vector2d> points, const SvgStyle& style);
  void polygon(std::span<const Eigen::Vector2d> points, const SvgStyle& style);
  /// Round dots of the stroke's colour and width.
  void dots(std::span<const Eigen::Vector2d> points, const SvgStyle& style);
  void circle(const Eigen::Vector2d& centre, double radius, const SvgStyle& style);
  void ellipse(const Eigen::Vector2d& centre, const Eigen::Vector2d& radii, double rotation_deg,
               const SvgStyle& style);
  void text(const Eigen::Vector2d& at, std::string_view text, const SvgFont& font = {});

  /// Everything drawn until end_clip() is visible only within the box.
  void begin_clip(const SvgBox& box);
  void end_clip();

  /// The whole document.
  std::string str() const { return body_ + "</svg>\n"; }

 private:
  std::string body_;
  int clips_ = 0;
};

/// A round step, 1, 2 or 5 times a power of ten, of which about `count` fit into `extent`.
double round_step(double extent, int count);

}  // namespace posemix::internal
