// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "csv_table.hpp"
#include "posemix/base/linear.hpp"

/// Poses with covariances in CSV tables: columns `tx_m` ... `qw` and `c00`, `c01`, ..., `c55`.
namespace posemix::internal {

inline constexpr std::array<const char*, 7> kPoseFields{"tx_m", "ty_m", "tz_m", "qx",
                                                        "qy",   "qz",   "qw"};

/// The names of the columns of a covariance's upper triangle, row by row.
const std::vector<std::string>& covariance_columns();

/// The names of the columns, separated by commas.
std::string pose_header();
std::string covariance_header();

/// The fields of a row, separated by commas, with 12 significant digits; empty ones for no
/// covariance.
std::string pose_fields(const SE3d& pose);
std::string covariance_fields(const std::optional<Matrix6d>& covariance);

/// @throws InvalidInput at the row for a number that is none or a quaternion that is not a unit
SE3d pose_in(const CsvTable& table);
/// Nothing where all fields are empty, the table has no such columns, or a placeholder stands
/// there.
/// @throws InvalidInput at the row when some fields are empty and others are not
std::optional<Matrix6d> covariance_in(const CsvTable& table);

}  // namespace posemix::internal
