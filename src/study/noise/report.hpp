// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <span>
#include <string>

#include "study/engine/study.hpp"

namespace posemix {

inline constexpr std::array<const char*, 6> kNoiseAxes{
    "rotation_x", "rotation_y", "rotation_z", "translation_x", "translation_y", "translation_z"};

/// The report of `study noise` from the results of its work items.
StudyReport report_noise(std::span<const std::string> results);

}  // namespace posemix
