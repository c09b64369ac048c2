// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "scene.hpp"
#include "study.hpp"

namespace posemix {

/// What scenes with truth tell of a detector.
struct LearnedDetector {
  DetectorNoise noise;
  double detection_probability;
  double turned_share;
};

/// Learns from scenes of one dataset: the noise from the row nearest to each true pose (fit_noise,
/// up to three components along the viewing ray), clutter from it and from the rows at no object.
/// @throws InvalidInput where the scenes have too few rows
LearnedDetector learned_detector(const std::vector<const MultiViewScene*>& scenes,
                                 const FuseViewsStudySettings& settings);

}  // namespace posemix
