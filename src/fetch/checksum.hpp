// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace posemix {

/// Called with the number of bytes of a file that are done; returning false stops the work.
using ByteProgress = std::function<bool(std::uint64_t bytes)>;

/// Size and hash of a file.
struct FileContent {
  std::uint64_t size = 0;
  std::string sha256;  ///< 64 hexadecimal digits in lower case
};

/// Computes size and SHA-256 of a file; empty if `progress` stopped it.
/// @throws InvalidInput naming the file that cannot be read
std::optional<FileContent> content_of_file(const std::filesystem::path& path,
                                           const ByteProgress& progress = {});

}  // namespace posemix
