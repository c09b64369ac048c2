// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "poses.hpp"

namespace posemix::python {

/// Conversion of a setting's value between C++ and Python, comparison, and its text in a repr.
template <class Value>
struct SettingValue {
  static constexpr bool kIsArray = false;
  static nb::object get(const Value& value) { return nb::cast(value, nb::rv_policy::copy); }
  static Value set(nb::handle value, const std::string& /*name*/) { return nb::cast<Value>(value); }
  static bool same(const Value& a, const Value& b) { return get(a).equal(get(b)); }
  static std::string text(const Value& value) { return nb::repr(get(value)).c_str(); }
};

/// Whether a value can change its type; Python gets no reference to such a value.
template <class Value>
inline constexpr bool kIsVariant = false;
template <class... Values>
inline constexpr bool kIsVariant<std::variant<Values...>> = true;

/// Vectors and matrices, from any value that numpy can convert to an array.
template <int Rows, int Columns, int Options, int MaxRows, int MaxColumns>
struct SettingValue<Eigen::Matrix<double, Rows, Columns, Options, MaxRows, MaxColumns>> {
  using Value = Eigen::Matrix<double, Rows, Columns, Options, MaxRows, MaxColumns>;
  static constexpr bool kIsArray = true;
  static nb::object get(const Value& value) { return nb::cast(value, nb::rv_policy::copy); }

  static Value set(nb::handle value, const std::string& name) {
    const nb::object array =
        nb::module_::import_("numpy").attr("asarray")(value, nb::arg("dtype") = "float64");
    try {
      return nb::cast<Value>(array);
    } catch (const nb::cast_error&) {
      throw InvalidInput(fmt::format("{} has shape {}; expected {}", name,
                                     nb::repr(array.attr("shape")).c_str(), shape()));
    }
  }
  static bool same(const Value& a, const Value& b) {
    return a.size() == b.size() && (a.array() == b.array()).all();
  }
  static std::string text(const Value& value) {
    if constexpr (Columns == 1) {
      return numbers(value);
    } else {
      if (value.isDiagonal(0.0)) return "diag(" + numbers(value.diagonal()) + ")";
      std::string all = "[";
      for (Eigen::Index i = 0; i < value.rows(); ++i)
        all += (i == 0 ? "" : ", ") + numbers(value.row(i).transpose());
      return all + "]";
    }
  }

 private:
  static std::string shape() {
    if constexpr (Columns == 1) return Rows < 0 ? "(n,)" : fmt::format("({},)", Rows);
    return fmt::format("({}, {})", Rows, Columns);
  }
  static std::string numbers(const Eigen::VectorXd& values) {
    return fmt::format("[{:.6g}]", fmt::join(values, ", "));
  }
};

template <>
struct SettingValue<SE3d> {
  static constexpr bool kIsArray = false;
  static nb::object get(const SE3d& value) { return nb::cast(value); }
  static SE3d set(nb::handle value, const std::string& /*name*/) { return nb::cast<SE3d>(value); }
  static bool same(const SE3d& a, const SE3d& b) {
    return a.translation() == b.translation() &&
           a.rotation().quaternion().coeffs() == b.rotation().quaternion().coeffs();
  }
  static std::string text(const SE3d& value) {
    double row[7];
    Wire<SE3d>::write(value, row);
    return fmt::format("SE3([{:.6g}])", fmt::join(row, ", "));
  }
};

template <class Value>
struct SettingValue<std::optional<Value>> {
  using Inner = SettingValue<Value>;
  static constexpr bool kIsArray = false;
  static nb::object get(const std::optional<Value>& value) {
    return value ? Inner::get(*value) : nb::object(nb::none());
  }
  static std::optional<Value> set(nb::handle value, const std::string& name) {
    if (value.is_none()) return std::nullopt;
    return Inner::set(value, name);
  }
  static bool same(const std::optional<Value>& a, const std::optional<Value>& b) {
    return a.has_value() == b.has_value() && (!a || Inner::same(*a, *b));
  }
  static std::string text(const std::optional<Value>& value) {
    return value ? Inner::text(*value) : "None";
  }
};

}  // namespace posemix::python
