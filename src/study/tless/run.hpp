// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "scene.hpp"
#include "study.hpp"

namespace posemix {

/// The scene with synthetic odometry: the true motion of the camera with noise.
Sequence with_synthetic_odometry(const TlessScene& scene, const TlessStudySettings& settings);

/// Runs one scene, with or without declared symmetries. Returns
/// {"instances": [...], "scene": {...}}, rows of named numbers.
nlohmann::ordered_json run_tless(const TlessScene& scene, const TlessStudySettings& settings,
                                 bool declared);

}  // namespace posemix
