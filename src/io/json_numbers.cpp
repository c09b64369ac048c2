// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "json_numbers.hpp"

#include <charconv>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace posemix::internal {

std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json json_number(const std::optional<double>& number) {
  return number && std::isfinite(*number) ? Json(*number) : Json(nullptr);
}

double rounded(double number, int digits) {
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "{:.{}g}", number, digits);
  double result = number;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result + 0.0;
}

Json json_vector(const Eigen::Ref<const Eigen::VectorXd>& vector, int digits) {
  Json array = Json::array();
  for (const double number : vector) array.push_back(json_number(rounded(number, digits)));
  return array;
}

Json json_pose(const std::optional<SE3d>& pose, int digits) {
  if (!pose) return nullptr;
  Eigen::Matrix<double, 7, 1> numbers;
  numbers << pose->translation(), pose->rotation().quaternion().coeffs();
  return json_vector(numbers, digits);
}

}  // namespace posemix::internal
