// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace posemix {

/// Called with the number of files unpacked so far; returning false stops the work.
using UnpackProgress = std::function<bool(std::size_t files)>;

/// True for names of archives that unpack_archive reads: .zip, .tar, .tar.gz, .tgz, .tar.xz,
/// .tar.bz2.
bool is_archive_name(const std::string& name);

/// Unpacks the files of an archive below `folder`, without the leading folder `strip` if that is
/// given; files of the same name are replaced. Returns the number of files; empty if it was
/// stopped.
///
/// Entries that lead out of the folder, are links or devices, or would be written through a
/// symbolic link are refused.
/// @throws InvalidInput naming archive and entry, OutputError
std::optional<std::size_t> unpack_archive(const std::filesystem::path& archive,
                                          const std::filesystem::path& folder,
                                          const std::string& strip,
                                          const UnpackProgress& progress = {});

}  // namespace posemix
