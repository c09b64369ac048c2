// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace posemix {

/// Told how many bytes of a file are done; false stops the work.
using ByteProgress = std::function<bool(std::uint64_t bytes)>;

/// What a file holds.
struct FileContent {
  std::uint64_t size = 0;
  std::string sha256;  ///< 64 hexadecimal digits in lower case
};

/// Size and SHA-256 of a file; nothing where `progress` stopped it.
/// @throws InvalidInput naming the file that cannot be read
std::optional<FileContent> content_of_file(const std::filesystem::path& path,
                                           const ByteProgress& progress = {});

}  // namespace posemix
