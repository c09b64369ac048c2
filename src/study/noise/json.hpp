// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "posemix/detector/noise_fit.hpp"

/// Results of `study noise` as JSON and back.
namespace posemix {

/// The number, or null where it is not finite.
nlohmann::ordered_json finite_json(double value);
nlohmann::ordered_json modes_json(const std::vector<NoiseMode>& modes);
nlohmann::ordered_json validation_json(const std::vector<NoiseValidation>& rows);
nlohmann::ordered_json correlation_json(const NoiseCorrelation& correlation);
DetectorNoise noise_from_json(const nlohmann::ordered_json& json);

}  // namespace posemix
