// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "study/engine/study.hpp"
#include "study/engine/table.hpp"

namespace posemix {

/// The number of bins for the probability of a mode; all have the same width.
inline constexpr std::size_t kForecastBins = 10;

/// reliability.csv and reliability.svg: by detector and method, how often the mode was right
/// against its probability, every recording and object with the same weight.
std::vector<StudyFile> report_forecasts(std::span<const std::vector<Cell>> forecasts);

}  // namespace posemix
