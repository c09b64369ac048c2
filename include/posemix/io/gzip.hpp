// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace posemix {

/// The bytes of a file; those of a gzip file (RFC 1952, told by its first bytes) are uncompressed.
/// @throws InvalidInput as read_file, for a damaged gzip file, and for more than 1 GiB
std::string read_file_or_gzip(const std::filesystem::path& path);

/// The bytes as a gzip file, without name and time, so that equal bytes give equal files.
std::string gzip(std::string_view bytes);

}  // namespace posemix
