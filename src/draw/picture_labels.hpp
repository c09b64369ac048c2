// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <vector>

#include "svg.hpp"

namespace posemix::internal {

/// A text that belongs to a point of a drawing.
struct PointLabel {
  std::string text;
  std::string colour;
  Eigen::Vector2d at;  ///< the point [px]
};

/// The place of a label: its box, and the end of the line that leads to it from its point.
struct PlacedLabel {
  SvgBox box = {};
  Eigen::Vector2d leader_end = Eigen::Vector2d::Zero();
};

inline constexpr double kPointLabelSize = 13.0;

/// Places for all labels in an area: beside their points, off each other, off `marks` and off the
/// points of others, as near as there is room.
std::vector<PlacedLabel> place_labels(std::span<const PointLabel> labels, const SvgBox& area,
                                      std::span<const SvgBox> marks);

/// Draws labels with lines that lead from them to their points.
void draw_point_labels(SvgDocument& svg, std::span<const PointLabel> labels, const SvgBox& area,
                       std::span<const SvgBox> marks);

}  // namespace posemix::internal
