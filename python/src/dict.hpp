// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "arrays.hpp"

/// Results as Python lists and optional values.
namespace posemix::python {

/// A list of `f(element)` for all elements.
template <class Range, class Function>
nb::list list_of(const Range& range, Function f) {
  nb::list list;
  for (const auto& element : range) list.append(f(element));
  return list;
}

/// `f(value)`, or None without a value.
template <class Value, class Function>
nb::object or_none(const std::optional<Value>& value, Function f) {
  return value ? nb::object(nb::cast(f(*value))) : nb::object(nb::none());
}

template <class Value>
nb::object or_none(const std::optional<Value>& value) {
  return or_none(value, [](const Value& v) { return v; });
}

}  // namespace posemix::python
