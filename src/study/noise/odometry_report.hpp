// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "study/noise/study.hpp"

namespace posemix {

/// The work item of the odometry.
nlohmann::ordered_json study_odometry(const std::vector<OdometryRecording>& recordings,
                                      const NoiseStudySettings& settings);

/// Adds the files of the item to the report.
void report_odometry(const nlohmann::ordered_json& item, StudyReport& report);

}  // namespace posemix
