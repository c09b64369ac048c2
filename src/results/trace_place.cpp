// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trace_place.hpp"

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix::internal {

std::string TracePlace::text() const {
  if (parent_ == nullptr) return fmt::format("{}[{}]", path_, index_);
  if (path_.empty()) return fmt::format("{}[{}]", parent_->text(), index_);
  return fmt::format("{}: {}", parent_->text(), path_);
}

void TracePlace::fail(std::string_view got, std::string_view expected) const {
  throw InvalidInput(fmt::format("{}: got {}, expected {}", text(), got, expected));
}

TracePlace TracePlace::member(std::string_view key) const {
  if (!value_->is_object()) fail(value_->type_name(), "an object");
  const auto found = value_->find(key);
  if (found == value_->end()) fail(fmt::format("no key '{}'", key), "one");
  return {*found, key, 0, this};
}

std::size_t TracePlace::size() const {
  if (!value_->is_array()) fail(value_->type_name(), "an array");
  return value_->size();
}

double TracePlace::number() const {
  if (!value_->is_number()) fail(value_->type_name(), "a number");
  return value_->get<double>();
}

double TracePlace::number_in(double lowest, double highest) const {
  const double value = number();
  if (!(value >= lowest && value <= highest)) {
    fail(fmt::format("{}", value), fmt::format("a number from {} to {}", lowest, highest));
  }
  return value;
}

double TracePlace::probability() const {
  constexpr double kRounding = 1e-6;
  const double value = number();
  if (!(value >= 0.0 && value <= 1.0 + kRounding)) fail(fmt::format("{}", value), "a probability");
  return value;
}

void TracePlace::numbers(std::span<double> values) const {
  if (size() != values.size()) {
    fail(fmt::format("{} entries", size()), fmt::format("{}", values.size()));
  }
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = item(i).number();
}

}  // namespace posemix::internal
