// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/fiducial/tag_pose.hpp"

namespace posemix {

/// The noise of corners that was learned from sightings.
struct CornerNoiseFit {
  CornerNoise noise = {};
  std::size_t sightings = 0;  ///< from which it was learned
  bool converged = false;
};

/// Degrees of freedom of the noise that fit_corner_noise looks for; the upper end is as good as
/// normal.
inline constexpr double kLeastCornerDof = 1.0;
inline constexpr double kMostCornerDof = 1000.0;

/// The logarithm of the integral of a sighting's likelihood over the poses around one minimum
/// (flat prior) and over the sighting's variance, up to a constant that the minima of a sighting
/// share.
double log_evidence(const TagMinimum& minimum, const CornerNoise& noise);

/// The noise that makes the corners of sightings most likely, by expectation maximisation.
///
/// Six of the eight coordinates of a sighting go into its pose; what is left of the squared error E
/// of the true minimum is F-distributed, E / (2 sd^2) ~ F(2, dof). Which minimum is the true one is
/// not known: the likelihood sums over them, so that ambiguous sightings need no selection, which
/// would bias the noise.
/// @param sightings the minima of each sighting, at least one sighting; those without minima are
/// not counted
/// @throws InvalidInput when no sighting has a minimum
CornerNoiseFit fit_corner_noise(std::span<const std::vector<TagMinimum>> sightings);

}  // namespace posemix
