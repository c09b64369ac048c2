// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/lie/se3.hpp"

namespace posemix {

/// A group of poses that are drawn in one colour.
struct FlagGroup {
  std::string label;
  std::string colour;  ///< as "#009E73"
  std::vector<SE3<double>> poses;
};

/// A box drawn by its edges, centred at a pose.
struct OutlinedBox {
  SE3<double> pose;
  Eigen::Vector3d size;  ///< edge lengths [m]
};

/// The view of flags: from a point far away, in the frame of the poses with x to the right, y down
/// and z into the depth, turned by `yaw` to the side and `pitch` from above.
struct FlagView {
  Eigen::Vector3d centre;  ///< point in the middle of the picture [m]
  double extent;           ///< half of the picture's width [m]
  double yaw_deg = 35.0;
  double pitch_deg = 25.0;
  double flag = 0.03;  ///< length of a pole [m]
};

/// The view in which all poses of all groups fit, with the poles.
FlagView view_of(std::span<const FlagGroup> groups, double flag = 0.03);

/// Poses as flags (MPG paper, section VI): the foot is the position, the pole the z axis, the
/// pennant's tip points along the x axis. One SVG document; a triad shows the axes of the frame.
/// @throws InvalidInput for an extent or a flag that is not positive
std::string draw_flags(std::string_view title, std::span<const FlagGroup> groups,
                       const FlagView& view, const std::optional<OutlinedBox>& box = {});

}  // namespace posemix
