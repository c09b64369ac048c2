// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/detector/observation.hpp"

/// Observations as a CSV table with one row per component.
///
/// Columns: `stamp_s,camera,detector,id,class,sighting,weight,tx_m,ty_m,tz_m,qx,qy,qz,qw` and
/// `c00,c01,...,c55`, the upper triangle row by row of the covariance of n of T_camera_object
/// Exp(n), rotation [rad] before translation [m], which may be missing, all of them; `clutter` and
/// `score` may follow. `sighting` is
/// an integer that the components of one observation share; their rows follow each other. Of `id`
/// and `class` one is given; camera, detector, clutter, score may be empty, and so may a
/// covariance, as a whole: it is then that of the detector's noise. So it is for a placeholder
/// (is_placeholder_covariance).
namespace posemix {

/// The observations of a table, in the order of the file; lines that start with '#' are skipped.
/// @throws InvalidInput `name:line: got ..., expected ...`; also as validate, when a sighting's
/// rows do not follow each other or differ in what is one for all, and when there are no rows
std::vector<Observation> parse_observations(std::string_view text, const std::string& name);

/// Reads a file, which may be compressed by gzip, as parse_observations reads a text.
std::vector<Observation> read_observations(const std::filesystem::path& path);

/// The table of observations, whose sightings are counted from zero: poses and covariances with 12
/// significant digits, stamps and weights with as many as are needed to read back the same number.
/// @throws InvalidInput as validate, and for a name with a comma, a line break or blanks at an end
std::string format_observations(std::span<const Observation> observations);

}  // namespace posemix
