// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include <nlohmann/json.hpp>

#include "study/noise/groups.hpp"

namespace posemix {

/// The result of one work item: statistics, histograms and models.
nlohmann::ordered_json study_noise(const NoiseGroup& group, const NoiseStudySettings& settings,
                                   std::size_t item);

}  // namespace posemix
