// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace posemix {

/// Whether translations are in shares of the range.
bool along_ray(const nlohmann::ordered_json& item);

/// The model of a group of detections that the BIC chose.
const nlohmann::ordered_json& chosen_model(const nlohmann::ordered_json& item);

/// The residuals of a group of detections along each axis, with the densities of the models.
std::string draw_residuals(const nlohmann::ordered_json& item);

}  // namespace posemix
