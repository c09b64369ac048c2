// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace posemix {

/// A text of tables, with blank lines between them, in at most `most_lines` lines: every table
/// keeps its first rows, and as many as the others leave, and a line says how many rows are left
/// out. A text that fits stays as it is.
std::string screen_text(std::string_view text, std::size_t most_lines);

}  // namespace posemix
