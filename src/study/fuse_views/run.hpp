// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "learned.hpp"
#include "scene.hpp"
#include "study.hpp"

namespace posemix {

/// Key of the learned noise, as a table [noise.detector], in rows that use it.
inline constexpr const char* kLearnedNoise = "learned_noise";

/// The rows of one scene: one for every kind of groups, of input, of symmetries, and of the
/// detector: the default noise and what was learned from other scenes.
nlohmann::ordered_json run_fuse_views(const MultiViewScene& scene,
                                      const FuseViewsStudySettings& settings,
                                      const LearnedDetector& learned);

}  // namespace posemix
