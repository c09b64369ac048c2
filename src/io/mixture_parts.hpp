// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

#include "posemix/io/mixture_file.hpp"
#include "posemix/io/rigid.hpp"

/// The words of mixture files and the conversions of convention, for writer and reader.
namespace posemix::internal {

inline constexpr std::string_view kMixtureType = "posemix.mixture";
inline constexpr std::string_view kMixtureGroup = "SE3";
inline constexpr std::string_view kConcentratedWord = "concentrated";
inline constexpr std::string_view kProjectedWord = "projected";
/// The unit of u for projected Gaussians, tan(theta/2).
inline constexpr std::string_view kProjectedUnit = "tan_half_angle";
inline constexpr std::size_t kLongestFrameName = 100;

/// Metres per unit of length.
double metres_per_unit(LengthUnit unit);

/// Convert a covariance of [rotation; translation] from rad and m to units and order of the
/// convention, and back. `angle` is the unit of the rotation if it has a unit.
Matrix6d stated_covariance(const Matrix6d& covariance, const MixtureConvention& convention);
Matrix6d plain_covariance(const Matrix6d& stated, const MixtureConvention& convention);

/// Whether all coordinates are finite and within kFarthestPosition.
bool is_position(const Eigen::Vector3d& translation);

bool is_frame_name(std::string_view name);

}  // namespace posemix::internal
