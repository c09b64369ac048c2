// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "posemix/io/mixture_file.hpp"
#include "posemix/io/rigid.hpp"

/// Words of mixture files and changes of convention that writer and reader share.
namespace posemix {

inline constexpr std::string_view kMixtureType = "posemix.mixture";
inline constexpr std::string_view kMixtureGroup = "SE3";
inline constexpr std::string_view kConcentratedWord = "concentrated";
inline constexpr std::string_view kProjectedWord = "projected";
/// Unit of u of projected Gaussians, tan(theta/2).
inline constexpr std::string_view kProjectedUnit = "tan_half_angle";
inline constexpr std::size_t kLongestFrameName = 100;

template <class Value>
using Words = std::array<std::pair<std::string_view, Value>, 2>;

inline constexpr Words<Side> kSides{{{"left", Side::left}, {"right", Side::right}}};
inline constexpr Words<TangentOrder> kOrders{
    {{"rotation_translation", TangentOrder::rotation_translation},
     {"translation_rotation", TangentOrder::translation_rotation}}};
inline constexpr Words<AngleUnit> kAngleUnits{{{"rad", AngleUnit::rad}, {"deg", AngleUnit::deg}}};
inline constexpr Words<LengthUnit> kLengthUnits{{{"m", LengthUnit::m}, {"mm", LengthUnit::mm}}};

template <class Value>
std::string_view word_of(const Words<Value>& words, Value value) {
  return words[0].second == value ? words[0].first : words[1].first;
}

/// Metres per unit of length.
double metres_per_unit(LengthUnit unit);

/// A covariance of [rotation; translation] in rad and m as the convention states it, and back:
/// units and order. `angle` is the unit of the rotation where it has one.
Matrix6d stated_covariance(const Matrix6d& covariance, const MixtureConvention& convention);
Matrix6d plain_covariance(const Matrix6d& stated, const MixtureConvention& convention);

/// Whether all coordinates are finite and within kFarthestPosition.
bool is_position(const Eigen::Vector3d& translation);

bool is_frame_name(std::string_view name);

}  // namespace posemix
