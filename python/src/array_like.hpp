// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

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
  std::vector<bool> flags() const { return listed<bool>("bool"); }
  std::vector<std::size_t> indices() const { return listed<std::size_t>("intp"); }

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
  std::vector<Value> listed(const char* type) const {
    return nb::cast<std::vector<Value>>(raveled(type).attr("tolist")());
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

}  // namespace posemix::python
