// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "setting_value.hpp"

namespace posemix::python {

/// An argument that numpy can convert to an array.
class ArrayLike : public nb::object {
  NB_OBJECT_DEFAULT(ArrayLike, object, "numpy.typing.ArrayLike", is_any)

  /// The argument with the name `name` as a matrix or vector.
  /// @throws InvalidInput for another shape
  template <class Value>
  Value as(const std::string& name) const {
    return SettingValue<Value>::set(*this, name);
  }

  /// Its numbers one after the other.
  Eigen::VectorXd flat() const { return nb::cast<Eigen::VectorXd>(raveled("float64")); }
  /// @throws InvalidInput for a number that is neither zero nor one
  std::vector<bool> flags() const {
    return listed<bool>([](double v) { return v == 0.0 || v == 1.0; }, "true or false");
  }
  /// @throws InvalidInput for a number that is no integer, or negative
  std::vector<std::size_t> indices() const {
    // Larger integers are no doubles.
    const auto is_index = [](double v) { return v >= 0.0 && v <= 0x1p53 && v == std::floor(v); };
    return listed<std::size_t>(is_index, "integers that are zero or more");
  }

  /// Its shape as an array.
  std::vector<std::size_t> shape() const {
    return shape_of(nb::module_::import_("numpy").attr("shape")(*this));
  }

  static std::vector<std::size_t> shape_of(const nb::object& lengths) {
    std::vector<std::size_t> shape;
    for (const nb::handle n : lengths) shape.push_back(nb::cast<std::size_t>(n));
    return shape;
  }

 private:
  static bool is_any(PyObject* /*object*/) { return true; }
  nb::object raveled(const char* type) const {
    return nb::module_::import_("numpy")
        .attr("asarray")(*this, nb::arg("dtype") = type)
        .attr("ravel")();
  }
  template <class Value>
  std::vector<Value> listed(bool (*is_one)(double), const char* expected) const {
    std::vector<Value> values;
    for (const double number : flat()) {
      if (!is_one(number)) throw InvalidInput(fmt::format("got {}, expected {}", number, expected));
      values.push_back(static_cast<Value>(number));
    }
    return values;
  }
};

/// Rows of numbers, of an array of any shape before its last axis.
struct ShapedRows {
  Rows rows;
  std::vector<std::size_t> shape;  ///< without the last axis

  /// @throws InvalidInput for another number of columns
  ShapedRows(const ArrayLike& values, std::size_t columns, const char* name) {
    const nb::module_ arrays = nb::module_::import_("posemix._arrays");
    const nb::object array = arrays.attr("as_floats")(values, nb::make_tuple(columns), name);
    shape = ArrayLike::shape_of(array.attr("shape"));
    shape.pop_back();
    rows = nb::cast<Rows>(arrays.attr("flat_rows")(array, 1));
  }
};

/// Square matrices of an array of any shape before its last two axes.
/// @throws InvalidInput for another shape
inline Matrices matrices_of(const ArrayLike& values, std::size_t side, const char* name) {
  const nb::module_ arrays = nb::module_::import_("posemix._arrays");
  const nb::object array = arrays.attr("as_floats")(values, nb::make_tuple(side, side), name);
  return nb::cast<Matrices>(arrays.attr("flat_rows")(array, 2));
}

}  // namespace posemix::python
