// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "posemix/lie/lie.hpp"

/// How JSON files hold numbers and poses.
namespace posemix::internal {

using Json = nlohmann::ordered_json;

/// The text of a document, with a line end; `indent` blanks per level, none: all in one line. Bytes
/// that are not UTF-8 are replaced.
std::string json_text(const Json& json, int indent = -1);

/// A number; null where it is not finite or missing.
Json json_number(const std::optional<double>& number);

/// The number nearest to `number` that has so many significant digits.
double rounded(double number, int digits);

/// An array of numbers with so many significant digits.
Json json_vector(const Eigen::Ref<const Eigen::VectorXd>& vector, int digits);

/// [tx, ty, tz, qx, qy, qz, qw] with so many significant digits; null where there is no pose.
Json json_pose(const std::optional<SE3d>& pose, int digits);

}  // namespace posemix::internal
