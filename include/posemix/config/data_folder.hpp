// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

/// The folders of recordings.
namespace posemix {

/// The cache of `posemix data`: $XDG_CACHE_HOME/posemix, or ~/.cache/posemix if that variable is
/// not set, or the folder `data` if there is no home folder either.
std::filesystem::path data_cache_folder();

/// The data folder if none is given: the environment variable POSEMIX_DATA, otherwise the cache of
/// `posemix data`.
std::filesystem::path default_data_folder();

/// The folders below which a sequence file's relative paths are looked up, in order: only `data` if
/// it is given; otherwise the sequence file's own folder, then default_data_folder().
/// @throws InvalidInput when `data` is not a folder
std::vector<std::filesystem::path> data_folders(
    const std::filesystem::path& sequence_file,
    const std::optional<std::filesystem::path>& data = std::nullopt);

}  // namespace posemix
