// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include <nanobind/nanobind.h>

namespace posemix::python {

/// A FutureWarning for each; throws where warnings are errors.
void warn_of_old_names(const std::vector<std::string>& warnings);

/// Binds the readers and writers of observations.
void bind_observation_files(nanobind::module_& m);

}  // namespace posemix::python
