// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <nanobind/nanobind.h>

namespace posemix::python {

void bind_moving_object_settings(nanobind::module_& m);
void bind_moving_object(nanobind::module_& m);

}  // namespace posemix::python
