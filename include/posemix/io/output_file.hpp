// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <string_view>

#include "posemix/io/output_folder.hpp"

namespace posemix {

/// Writes a file that appears, or replaces the one that is there, as a whole or not at all: into
/// `.<name>.partial-<process>` beside it first, then by a rename when that is on the disk. A
/// symbolic link stays and what it points to is replaced; what is no regular file, as a pipe or
/// /dev/null, is written to as it is. Throws OutputError.
void write_output_file(const std::filesystem::path& path, std::string_view content);

}  // namespace posemix
