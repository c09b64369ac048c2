// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include "setting_value.hpp"

/// What Python sees of a part of a bound struct. An assignment to the part either changes the
/// struct or raises an error: it is never made to a copy that nobody keeps.
namespace posemix::python {

/// A struct that is bound as a class of its own.
template <class Value>
concept BoundStruct =
    std::is_aggregate_v<Value> && nb::detail::is_base_caster_v<nb::detail::make_caster<Value>>;

template <class Value>
inline constexpr bool kIsVariant = false;
template <class... Values>
inline constexpr bool kIsVariant<std::variant<Values...>> = true;

template <class Value>
inline constexpr bool kIsOptional = false;
template <class Value>
inline constexpr bool kIsOptional<std::optional<Value>> = true;

/// Lists; an array of poses is no list in Python.
template <class Value>
inline constexpr bool kIsList = false;
template <class Value>
inline constexpr bool kIsList<std::vector<Value>> =
    !std::is_same_v<Value, SE3d> && !std::is_same_v<Value, std::optional<SE3d>>;

/// Arrays whose numbers are within the struct. Those of any size move when they are assigned.
template <class Value>
inline constexpr bool kIsArray = false;
template <class Value>
requires std::is_base_of_v<Eigen::MatrixBase<Value>, Value>
inline constexpr bool kIsArray<Value> = Value::SizeAtCompileTime != Eigen::Dynamic;

inline nb::object frozen_class(nb::handle type) {
  return nb::module_::import_("posemix._frozen").attr("frozen_class")(type);
}

inline bool is_frozen(nb::handle self) { return nb::hasattr(self, "_is_frozen"); }

/// A copy of which no attribute can be assigned.
template <BoundStruct T>
nb::object frozen(const T& value) {
  const nb::object made = nb::inst_alloc(frozen_class(nb::type<T>()));
  new (nb::inst_ptr<T>(made)) T(value);
  nb::inst_mark_ready(made);
  return made;
}

/// The same of any value; a list becomes a tuple where its elements are settings.
template <class Value>
nb::object frozen(const Value& value) {
  if constexpr (requires { SettingValue<Value>::frozen(value); }) {
    return SettingValue<Value>::frozen(value);
  } else if constexpr (kIsVariant<Value>) {
    return std::visit([](const auto& held) { return frozen(held); }, value);
  } else if constexpr (kIsOptional<Value>) {
    return value ? frozen(*value) : nb::object(nb::none());
  } else if constexpr (kIsList<Value>) {
    nb::list parts;
    for (const auto& each : value)
      parts.append(frozen(static_cast<typename Value::value_type>(each)));
    using Element = typename Value::value_type;
    if constexpr (BoundStruct<Element>) {
      const nb::handle type = nb::type<Element>();
      if (!frozen_class(type).is(type)) return nb::tuple(parts);
    }
    return parts;
  } else {
    return SettingValue<Value>::get(value);
  }
}

/// A copy of an array that cannot be changed; of other values the value.
inline nb::object read_only(nb::object value) {
  if (nb::hasattr(value, "setflags")) value.attr("setflags")(nb::arg("write") = false);
  return value;
}

/// A copy as what cannot be changed in place, where a change would be lost: a list as a tuple, a
/// dict and a set as frozen ones, an array that is read-only.
inline nb::object unchangeable(const nb::object& value) {
  if (nb::isinstance<nb::list>(value)) {
    nb::list parts;
    for (const nb::handle each : value) parts.append(unchangeable(nb::borrow(each)));
    return nb::tuple(parts);
  }
  if (nb::isinstance<nb::dict>(value))
    return nb::module_::import_("posemix._frozen").attr("FrozenDict")(value);
  if (nb::isinstance<nb::set>(value)) return nb::frozenset(value);
  return read_only(value);
}

/// The part of an object of settings: a reference where the part stays in its place for as long as
/// the object lives; a frozen copy otherwise, and where the object itself is frozen.
template <class Value>
nb::object part_of(nb::handle self, Value& value) {
  if constexpr (requires { SettingValue<Value>::part(self, value); }) {
    return SettingValue<Value>::part(self, value);
  } else if constexpr (kIsList<Value>) {
    return nb::tuple(frozen(value));
  } else if constexpr (BoundStruct<Value> || kIsArray<Value>) {
    if (is_frozen(self)) return read_only(frozen(value));
    return nb::cast(value, nb::rv_policy::reference_internal, self);
  } else {
    return read_only(frozen(value));
  }
}

}  // namespace posemix::python
