// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "scene.hpp"
#include "study.hpp"

namespace posemix {

/// The rows of one scene: one for every kind of groups, of input and of symmetries.
nlohmann::ordered_json run_fuse_views(const MultiViewScene& scene,
                                      const FuseViewsStudySettings& settings);

}  // namespace posemix
