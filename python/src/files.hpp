// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

namespace posemix::python {

/// A FutureWarning for each; throws where warnings are errors.
void warn_of_old_names(const std::vector<std::string>& warnings);

}  // namespace posemix::python
