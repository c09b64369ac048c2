// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/detector/observation.hpp"

/// Observations as JSON lines: one object per sighting.
///
///     {"stamp_s":0.1,"id":"7","components":[{"weight":1,"pose":[tx,ty,tz,qx,qy,qz,qw]}]}
///
/// Of `id` and `class` one is given. `camera`, `detector`, `sighting` (an integer that no other
/// line has), `clutter`, `score`, and `covariance` of a component may be missing or null; the
/// latter is the upper triangle, 21 numbers row by row, of the covariance of n of T_camera_object
/// Exp(n), rotation [rad] before translation [m]. A placeholder (is_placeholder_covariance) is
/// none.
namespace posemix {

/// The observations of a text, in its order; blank lines and lines that start with '#' are skipped.
/// @throws InvalidInput `name:line: key: got ..., expected ...`: also for a key that is unknown or
/// there twice, a sighting again, as validate, and when there are no observations
std::vector<Observation> parse_observation_lines(std::string_view text, const std::string& name);

/// Reads a file, which may be compressed by gzip, as parse_observation_lines reads a text.
std::vector<Observation> read_observation_lines(const std::filesystem::path& path);

/// The lines of observations, whose sightings are counted from zero; all numbers are read back bit
/// by bit.
/// @throws InvalidInput as validate, and unless an observation has one of id and class
std::string format_observation_lines(std::span<const Observation> observations);

}  // namespace posemix
