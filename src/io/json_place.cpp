// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "json_place.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "json_fault.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {

Json parse_json(std::string_view text, const std::string& name, std::string_view expected) {
  std::vector<std::set<std::string>> open;
  const auto check = [&](int depth, Json::parse_event_t event, const Json& parsed) {
    check_json_depth(depth, name);
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key &&
        !open.back().insert(parsed.get<std::string>()).second) {
      throw InvalidInput(fmt::format("{}: got the key {} twice in one object, expected once", name,
                                     in_quotes(parsed.get<std::string>())));
    }
    return true;
  };
  try {
    return Json::parse(text, check);
  } catch (const Json::exception& error) {
    refuse_json(error, name, expected);
  }
}

void JsonPlace::fail(std::string_view got, std::string_view expected) const {
  throw InvalidInput(fmt::format("{}: got {}, expected {}", path_, got, expected));
}

void JsonPlace::refuse(std::string_view message) const {
  throw InvalidInput(fmt::format("{}: {}", path_, message));
}

JsonPlace JsonPlace::member(std::string_view key) const {
  if (!json_->is_object()) fail(json_->type_name(), "an object");
  const auto found = json_->find(std::string(key));
  if (found == json_->end()) fail("no key '" + std::string(key) + "'", "one");
  return {*found, fmt::format("{}: {}", path_, key)};
}

bool JsonPlace::has(std::string_view key) const { return json_->contains(std::string(key)); }

std::vector<std::string> JsonPlace::keys() const {
  if (!json_->is_object()) fail(json_->type_name(), "an object");
  std::vector<std::string> keys;
  for (const auto& [key, value] : json_->items()) keys.push_back(key);
  return keys;
}

void JsonPlace::require_only(std::initializer_list<std::string_view> keys) const {
  if (!json_->is_object()) fail(json_->type_name(), "an object");
  for (const auto& [key, value] : json_->items()) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
      fail(fmt::format("the unknown key {}", in_quotes(key)),
           fmt::format("none but {}", fmt::join(keys, ", ")));
    }
  }
}

std::vector<JsonPlace> JsonPlace::items(std::optional<std::size_t> size) const {
  if (!json_->is_array()) fail(json_->type_name(), "an array");
  if (size && json_->size() != *size) {
    fail(fmt::format("{} entries", json_->size()), fmt::format("{}", *size));
  }
  std::vector<JsonPlace> items;
  items.reserve(json_->size());
  for (std::size_t i = 0; i < json_->size(); ++i) {
    items.emplace_back((*json_)[i], fmt::format("{}[{}]", path_, i));
  }
  return items;
}

double JsonPlace::number() const {
  const double number =
      json_->is_number() ? json_->get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!std::isfinite(number)) {
    fail(json_->is_number() ? "a number that is not finite" : json_->type_name(), "a number");
  }
  return number;
}

std::string JsonPlace::string() const {
  if (!json_->is_string()) fail(json_->type_name(), "a string");
  return json_->get<std::string>();
}

void JsonPlace::require_word(std::string_view expected) const {
  const std::string word = string();
  if (word != expected) fail(in_quotes(word), in_quotes(expected));
}

Eigen::VectorXd JsonPlace::vector(std::size_t size) const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(size));
  Eigen::Index at = 0;
  for (const JsonPlace& item : items(size)) result[at++] = item.number();
  return result;
}

Eigen::MatrixXd JsonPlace::square_matrix(std::size_t size) const {
  const std::vector<JsonPlace> rows = items(size);
  Eigen::MatrixXd result(size, size);
  Eigen::Index row = 0;
  for (const JsonPlace& item : rows) result.row(row++) = item.vector(size).transpose();
  return result;
}

SO3d JsonPlace::rotation() const {
  const Eigen::Vector4d xyzw = vector(4);
  const double norm = xyzw.stableNorm();
  if (!(std::abs(norm - 1.0) <= kJsonNormTolerance)) {
    fail(fmt::format("norm {:.9g}", norm), "norm 1");
  }
  return SO3d::from_stored_quaternion(Eigen::Quaterniond(xyzw));
}

}  // namespace posemix::internal
