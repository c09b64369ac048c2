// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include <nlohmann/json.hpp>

#include "study/grasp/data.hpp"

namespace posemix {

/// The result of one work item: what a fold learns, and its predictions.
nlohmann::ordered_json run_grasp_fold(const GraspData& data, std::size_t fold,
                                      const GraspStudySettings& settings);

}  // namespace posemix
