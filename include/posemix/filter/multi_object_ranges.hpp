// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string_view>

#include "posemix/base/range.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix {

/// A setting of the multi-object filter that is a number: its name, which is its key in files too,
/// its field, and the values that it may have.
struct MultiObjectNumber {
  std::string_view name;
  double MultiObjectSettings::*field;
  NumberRange range;
};

/// All of them but merge_rotation_rad, which files state in degrees.
inline constexpr std::array kMultiObjectNumbers{
    MultiObjectNumber{"explained_probability", &MultiObjectSettings::explained_probability,
                      kOpenUnitInterval},
    MultiObjectNumber{"default_clutter",
                      &MultiObjectSettings::default_clutter,
                      {.lowest = 0, .highest = 1, .without_highest = true}},
    MultiObjectNumber{"birth_score", &MultiObjectSettings::birth_score, kNotNegative},
    MultiObjectNumber{"score_memory", &MultiObjectSettings::score_memory, kUnitInterval},
    MultiObjectNumber{"merge_translation_m", &MultiObjectSettings::merge_translation_m,
                      kNotNegative},
    MultiObjectNumber{"merge_probability", &MultiObjectSettings::merge_probability,
                      kOpenUnitInterval},
    MultiObjectNumber{"leader_margin", &MultiObjectSettings::leader_margin, kNotNegative},
    MultiObjectNumber{"split_loss", &MultiObjectSettings::split_loss, kNotNegative},
    MultiObjectNumber{"camera_gain", &MultiObjectSettings::camera_gain, kUnitInterval},
    MultiObjectNumber{"slow_error_gain", &MultiObjectSettings::slow_error_gain, kUnitInterval},
    MultiObjectNumber{"camera_rotation_correction",
                      &MultiObjectSettings::camera_rotation_correction, kUnitInterval},
    MultiObjectNumber{"camera_position_correction",
                      &MultiObjectSettings::camera_position_correction, kUnitInterval},
    MultiObjectNumber{"noise_scale_detections",
                      &MultiObjectSettings::noise_scale_detections,
                      {.lowest = 0, .without_lowest = true, .with_infinity = true}},
    MultiObjectNumber{"least_noise_scale",
                      &MultiObjectSettings::least_noise_scale,
                      {.lowest = 0, .highest = 1, .without_lowest = true}},
};

}  // namespace posemix
