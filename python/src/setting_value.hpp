// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "density.hpp"
#include "poses.hpp"

namespace posemix::python {

/// Conversion of a setting's value between C++ and Python, comparison, and its text in a repr.
template <class Value>
struct SettingValue {
  static nb::object get(const Value& value) { return nb::cast(value, nb::rv_policy::copy); }
  static Value set(nb::handle value, const std::string& /*name*/) { return nb::cast<Value>(value); }
  static bool same(const Value& a, const Value& b) { return get(a).equal(get(b)); }
  static std::string text(const Value& value) { return nb::repr(get(value)).c_str(); }
};

/// Numbers that are no numbers are the same: a copy equals what it is a copy of.
template <>
struct SettingValue<double> {
  static nb::object get(double value) { return nb::float_(value); }
  static double set(nb::handle value, const std::string& /*name*/) {
    return nb::cast<double>(value);
  }
  static bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
  static std::string text(double value) { return nb::repr(get(value)).c_str(); }
};

/// Vectors and matrices, from any value that numpy can convert to an array.
template <int Rows, int Columns, int Options, int MaxRows, int MaxColumns>
struct SettingValue<Eigen::Matrix<double, Rows, Columns, Options, MaxRows, MaxColumns>> {
  using Value = Eigen::Matrix<double, Rows, Columns, Options, MaxRows, MaxColumns>;
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
    return std::equal(a.reshaped().begin(), a.reshaped().end(), b.reshaped().begin(),
                      b.reshaped().end(), SettingValue<double>::same);
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
    return Rows < 0 ? "(n, m)" : fmt::format("({}, {})", Rows, Columns);
  }
  static std::string numbers(const Eigen::VectorXd& values) {
    return fmt::format("[{:.6g}]", fmt::join(values, ", "));
  }
};

template <>
struct SettingValue<SE3d> {
  static nb::object get(const SE3d& value) { return nb::cast(value); }
  static SE3d set(nb::handle value, const std::string& name) { return pose_of(value, name); }
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

/// Its text is made without the package's class, which is not there yet when the module is loaded.
template <>
struct SettingValue<ConcentratedSE3> {
  static nb::object get(const ConcentratedSE3& value) { return nb::cast(value); }
  static ConcentratedSE3 set(nb::handle value, const std::string& /*name*/) {
    return nb::cast<ConcentratedSE3>(value);
  }
  static bool same(const ConcentratedSE3& a, const ConcentratedSE3& b) {
    return SettingValue<SE3d>::same(a.mean(), b.mean()) && a.covariance() == b.covariance();
  }
  static std::string text(const ConcentratedSE3& value) {
    const Vector6d sd = value.covariance().diagonal().cwiseSqrt();
    const Eigen::Vector3d degrees = sd.head<3>() * (180.0 / std::numbers::pi);
    const Eigen::Vector3d millimetres = 1000.0 * sd.tail<3>();
    return fmt::format("ConcentratedGaussian({}, sd {:.3g} deg; {:.3g} mm)",
                       SettingValue<SE3d>::text(value.mean()), fmt::join(degrees, ", "),
                       fmt::join(millimetres, ", "));
  }
};

/// An SE3 of shape (n,).
template <>
struct SettingValue<std::vector<SE3d>> {
  using Value = std::vector<SE3d>;
  static nb::object get(const Value& value) { return PoseArray::of(value).made; }
  static Value set(nb::handle value, const std::string& name) {
    return elements_of<SE3d>(pose_rows(value, name), name.c_str());
  }
  static bool same(const Value& a, const Value& b) {
    return std::ranges::equal(a, b, SettingValue<SE3d>::same);
  }
  static std::string text(const Value& value) { return nb::repr(get(value)).c_str(); }
};

template <>
struct SettingValue<PoseStackd> {
  using Poses = SettingValue<std::vector<SE3d>>;
  static nb::object get(const PoseStackd& value) { return Poses::get(value.poses()); }
  static PoseStackd set(nb::handle value, const std::string& name) {
    return PoseStackd(Poses::set(value, name));
  }
  static bool same(const PoseStackd& a, const PoseStackd& b) {
    return Poses::same(a.poses(), b.poses());
  }
  static std::string text(const PoseStackd& value) { return Poses::text(value.poses()); }
};

/// Numbers as an array in place of a list.
struct NumbersAsArray {
  using Value = std::vector<double>;
  using Vector = SettingValue<Eigen::VectorXd>;
  static nb::object get(const Value& value) { return Vector::get(vector_of(value)); }
  static Value set(nb::handle value, const std::string& name) {
    const Eigen::VectorXd numbers = Vector::set(value, name);
    return {numbers.begin(), numbers.end()};
  }
  static bool same(const Value& a, const Value& b) { return a == b; }
  static std::string text(const Value& value) { return Vector::text(vector_of(value)); }

 private:
  static Eigen::VectorXd vector_of(const Value& value) {
    return Eigen::Map<const Eigen::VectorXd>(value.data(), std::ssize(value));
  }
};

template <class Value>
struct SettingValue<std::optional<Value>> {
  using Inner = SettingValue<Value>;
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

/// An SE3 of shape (n,), NaN for a miss; None where there is no entry.
template <>
struct SettingValue<MaybePoses> {
  static nb::object get(const MaybePoses& value) {
    if (value.empty()) return nb::none();
    return PoseArray::of(rows_of(value), {value.size()}).made;
  }
  static MaybePoses set(nb::handle value, const std::string& name) {
    if (value.is_none()) return {};
    return maybe_poses(pose_rows(value, name), name);
  }
  static bool same(const MaybePoses& a, const MaybePoses& b) {
    return std::ranges::equal(a, b, SettingValue<std::optional<SE3d>>::same);
  }
  static std::string text(const MaybePoses& value) { return nb::repr(get(value)).c_str(); }
};

}  // namespace posemix::python
