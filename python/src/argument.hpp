// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include "density.hpp"
#include "setting_value.hpp"

namespace posemix::python {

/// An argument of a function whose error names it and says what was expected, in place of a list of
/// the functions that there are.
template <class T>
struct Argument {
  nb::object given;

  /// @param expected what it should be, as "a ConcentratedGaussian over one pose"
  T as(const std::string& name, const char* expected = "") const {
    try {
      return SettingValue<T>::set(given, name);
    } catch (const nb::cast_error&) {
      throw nb::type_error(
          fmt::format("{} is of type {}; expected {}", name, type_name(given), expected).c_str());
    }
  }

  static std::string type_name(nb::handle object) {
    return nb::cast<std::string>(object.type().attr("__name__"));
  }
};

/// A sequence whose error names the entry that does not fit.
/// @param expected what every entry should be, as "an ObjectModel"
template <class T>
std::vector<T> entries_of(const Argument<std::vector<T>>& given, const std::string& name,
                          const char* expected) {
  if (!nb::isinstance<nb::sequence>(given.given)) {
    throw nb::type_error(fmt::format("{} is of type {}; expected a sequence, every entry {}", name,
                                     given.type_name(given.given), expected)
                             .c_str());
  }
  std::vector<T> entries;
  for (const nb::handle entry : given.given) {
    const Argument<T> each{nb::borrow(entry)};
    entries.push_back(each.as(fmt::format("{}[{}]", name, entries.size()), expected));
  }
  return entries;
}

inline constexpr const char* kOneDensity = "a ConcentratedGaussian over one pose";

template <class T>
inline constexpr auto kArgumentType = nb::detail::make_caster<T>::Name;
template <>
inline constexpr auto kArgumentType<SE3d> =
    nb::detail::const_name("posemix.lie.SE3 | numpy.typing.ArrayLike");

}  // namespace posemix::python

namespace nanobind::detail {

template <class T>
struct type_caster<posemix::python::Argument<T>> {
  NB_TYPE_CASTER(posemix::python::Argument<T>, posemix::python::kArgumentType<T>)

  bool from_python(handle source, std::uint32_t /*flags*/, cleanup_list* /*cleanup*/) noexcept {
    value.given = borrow(source);
    return true;
  }
};

}  // namespace nanobind::detail
