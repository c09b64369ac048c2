// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "posemix/lie/lie.hpp"

/// Numbers and poses in JSON files.
namespace posemix::internal {

using Json = nlohmann::ordered_json;

/// The text of a document, with a line end. `indent` is the number of blanks per level; negative:
/// all in one line. Bytes that are not UTF-8 are replaced.
std::string json_text(const Json& json, int indent = -1);

/// A number; null if it is not finite or missing.
Json json_number(const std::optional<double>& number);

/// `number` rounded to this many significant digits.
double rounded(double number, int digits);

/// An array of numbers with this many significant digits.
Json json_vector(const Eigen::Ref<const Eigen::VectorXd>& vector, int digits);

/// [tx, ty, tz, qx, qy, qz, qw] with this many significant digits; null without a pose.
Json json_pose(const std::optional<SE3d>& pose, int digits);

}  // namespace posemix::internal
