// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "posemix/slam/consistency.hpp"

/// Pictures of consistency.
namespace posemix {

/// The consistency of the estimates of one pose.
struct NamedConsistency {
  std::string name;
  ConsistencyReport report;
};

/// NEES per degree of freedom over time with the band in which 95 % of the frames lie if the
/// estimate is consistent, as SVG: of one pose for the whole, its rotation and its position; of
/// several, one panel each. Of a long series every point is the mean of some frames.
/// @throws InvalidInput without a pose, and for one without a frame
std::string draw_consistency(std::string_view title, std::span<const NamedConsistency> poses);

}  // namespace posemix
