// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

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

 private:
  static bool is_any(PyObject* /*object*/) { return true; }
};

}  // namespace posemix::python
