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
    MultiObjectNumber{"birth_covariance_factor", &MultiObjectSettings::birth_covariance_factor,
                      kPositive},
    MultiObjectNumber{"birth_score", &MultiObjectSettings::birth_score, kNotNegative},
    MultiObjectNumber{"score_memory", &MultiObjectSettings::score_memory, kUnitInterval},
    MultiObjectNumber{"merge_translation_m", &MultiObjectSettings::merge_translation_m,
                      kNotNegative},
    MultiObjectNumber{"merge_probability", &MultiObjectSettings::merge_probability,
                      kOpenUnitInterval},
    MultiObjectNumber{"leader_margin", &MultiObjectSettings::leader_margin, kNotNegative},
    MultiObjectNumber{"odometry_camera_fraction", &MultiObjectSettings::odometry_camera_fraction,
                      kUnitInterval},
    MultiObjectNumber{"camera_gain_noise",
                      &MultiObjectSettings::camera_gain_noise,
                      {.lowest = 1, .with_infinity = true}},
    MultiObjectNumber{"noise_scale_detections",
                      &MultiObjectSettings::noise_scale_detections,
                      {.lowest = 0, .without_lowest = true, .with_infinity = true}},
    MultiObjectNumber{"least_noise_scale",
                      &MultiObjectSettings::least_noise_scale,
                      {.lowest = 0, .highest = 1, .without_lowest = true}},
    MultiObjectNumber{"correlation_s", &MultiObjectSettings::correlation_s, kNotNegative},
    MultiObjectNumber{"correlation_detections",
                      &MultiObjectSettings::correlation_detections,
                      {.lowest = 0, .with_infinity = true}},
    MultiObjectNumber{"bias_variance_fraction",
                      &MultiObjectSettings::bias_variance_fraction,
                      {.lowest = 0, .highest = 1, .without_highest = true}},
    MultiObjectNumber{"mode_correlation_factor", &MultiObjectSettings::mode_correlation_factor,
                      kPositive},
};

}  // namespace posemix
