// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "posemix/detector/noise_fit.hpp"
#include "study/engine/study.hpp"

/// The white, slow and common errors in results and report of `study noise`.
namespace posemix {

/// The model for a filter, with its dependence, as JSON and back.
nlohmann::ordered_json dependent_noise_json(const DetectorNoise& noise);
DetectorNoise dependent_noise_from_json(const nlohmann::ordered_json& json);

/// Deviations and standard errors by axis (rotations in degrees), lengths, and the models tried.
nlohmann::ordered_json slow_error_json(const SlowErrorFit& fit);

/// Adds slow_error.csv, dependence.csv and slow_models.txt, and tables to the summary. The items
/// are those of study_noise.
void report_slow_errors(const std::vector<nlohmann::ordered_json>& items, StudyReport& report);

/// Lines of comment with the standard errors of the model of an item.
std::string slow_error_comment(const nlohmann::ordered_json& item);

}  // namespace posemix
