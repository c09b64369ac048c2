// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "arrays.hpp"

namespace posemix::python {

/// Copies that are objects of their own.
template <class T>
nb::class_<T>& with_copies(nb::class_<T>& made) {
  made.def("__copy__", [](const T& self) { return T(self); });
  made.def("__deepcopy__", [](const T& self, const nb::dict& /*memo*/) { return T(self); });
  return made;
}

}  // namespace posemix::python
