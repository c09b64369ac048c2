// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>

namespace posemix {

/// A text for a person, as a terminal may get it: whatever could move its cursor, change its title
/// or turn the direction of what follows is written as its bytes, "\x1b". These are control
/// characters but for tabs and line feeds, marks of direction, and bytes that are not UTF-8.
std::string terminal_text(std::string_view text);

/// The same on one line: a name cannot pretend to be a message of its own.
std::string terminal_line(std::string_view text);

}  // namespace posemix
