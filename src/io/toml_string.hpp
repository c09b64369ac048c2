// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

namespace posemix::internal {

/// A string of a sequence file, in quotes.
/// @throws InvalidInput for one with '${', which a sequence file reads as a variable
std::string toml_string(const std::string& text);

}  // namespace posemix::internal
