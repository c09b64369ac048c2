// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <string_view>

#include "posemix/io/output_folder.hpp"

namespace posemix {

/// Writes a file that appears, or replaces an existing one, as a whole or not at all: the content
/// is written to `.<name>.partial-<process>-<n>` beside it, and when that is on the disk it is
/// renamed. Several threads may write one file: it is that of one of them. A file that is replaced
/// keeps its permissions.
/// A symbolic link stays, and its target is replaced. If the path is not a regular file, such as a
/// pipe or /dev/null, the content is written to it directly.
/// @throws OutputError naming the path and the reason; std::system_error (std::errc::interrupted)
/// when a signal's handler ends the wait for a reader of a pipe
void write_output_file(const std::filesystem::path& path, std::string_view content);

}  // namespace posemix
