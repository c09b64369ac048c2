// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

namespace posemix {

/// True for a path with '/' that names something below the folder it is applied to: not empty,
/// not absolute, without parts that are empty, "." or "..", neither '\\' nor control characters.
bool is_inner_path(std::string_view path);

/// True if `text` matches `pattern`, in which '*' stands for any characters.
bool matches_pattern(std::string_view text, std::string_view pattern);

}  // namespace posemix
