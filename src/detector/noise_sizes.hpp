// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include "posemix/detector/noise_fit.hpp"

/// Models with different numbers of components.
namespace posemix::internal {

/// The settings of EM in one frame.
NoiseEmSettings em_settings(const NoiseFitSettings& settings, NoiseFrame frame,
                            std::size_t components);

/// Fits of 1, 2, ... components in one frame, as many as there are detections for.
std::vector<NoiseEmFit> fit_noise_sizes(std::span<const NoiseObservation> observations,
                                        const NoiseFitSettings& settings, NoiseFrame frame,
                                        RandomStream& stream);

}  // namespace posemix::internal
