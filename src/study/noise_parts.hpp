// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "posemix/study/noise.hpp"

namespace posemix {

/// The recordings that are studied together.
struct NoiseGroup {
  std::string detector;
  std::string object;
  std::vector<ResidualSet> sets;
};

inline constexpr std::array<const char*, 6> kNoiseAxes{
    "rotation_x", "rotation_y", "rotation_z", "translation_x", "translation_y", "translation_z"};

/// One group by detector and object, in the order of appearance, and `all` of a detector after its
/// objects where it has several.
std::vector<NoiseGroup> noise_groups(const std::vector<ResidualSet>& sets);

/// The result of one work item: statistics, histograms and models.
nlohmann::ordered_json study_noise(const NoiseGroup& group, const NoiseStudySettings& settings,
                                   std::size_t item);

/// Letters, digits, '_' and '-' of detector and object: the name of files and of the noise model.
std::string noise_name(const std::string& detector, const std::string& object);

StudyReport report_noise(std::span<const std::string> results);

nlohmann::ordered_json noise_to_json(const DetectorNoise& noise);
DetectorNoise noise_from_json(const nlohmann::ordered_json& json);

}  // namespace posemix
