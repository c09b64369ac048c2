// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>

#include "study.hpp"

namespace posemix {

/// @throws InvalidInput naming the setting
void check_monte_carlo_settings(const MonteCarloStudySettings& settings);

std::string monte_carlo_settings_json(const MonteCarloStudySettings& settings);

StudyReport report_monte_carlo(const MonteCarloStudySettings& settings,
                               std::span<const std::string> results);

}  // namespace posemix
