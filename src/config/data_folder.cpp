// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/data_folder.hpp"

#include <cstdlib>
#include <system_error>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

/// The folder in an environment variable; empty if that is not set or empty.
std::optional<fs::path> folder_of(const char* variable) {
  const char* named = std::getenv(variable);
  if (named == nullptr || *named == '\0') return std::nullopt;
  return named;
}

}  // namespace

fs::path data_cache_folder() {
  if (const auto cache = folder_of("XDG_CACHE_HOME")) return *cache / "posemix";
  if (const auto home = folder_of("HOME")) return *home / ".cache" / "posemix";
  return "data";
}

fs::path default_data_folder() {
  const auto named = folder_of("POSEMIX_DATA");
  return named ? *named : data_cache_folder();
}

std::vector<fs::path> data_folders(const fs::path& sequence_file,
                                   const std::optional<fs::path>& data) {
  if (data) {
    std::error_code ignored;
    if (fs::is_directory(*data, ignored)) return {*data};
    throw InvalidInput(
        fmt::format("{}: is not a folder, expected the data folder", data->string()));
  }
  const fs::path own = sequence_file.parent_path();
  return {own.empty() ? "." : own, default_data_folder()};
}

}  // namespace posemix
