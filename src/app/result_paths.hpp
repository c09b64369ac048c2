// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Results of one command that would replace each other.
namespace posemix {

/// The file or folder of a result, where one is wanted, and the option that names it.
struct NamedResult {
  std::string option;
  std::optional<std::string> path;
};

/// Whether a file of this name is written into a folder of results.
using IsResultName = std::function<bool(std::string_view)>;

/// Compares files by what they are, whatever their paths: links and `..` are followed. Several
/// results may go to what is no file, as /dev/null.
/// @throws CLI::ValidationError naming both options when two files are one
void require_different_files(std::span<const NamedResult> files);

/// @throws CLI::ValidationError naming both options when a file is the folder of results, or one
/// that is written into it
void require_beside_folder(std::span<const NamedResult> files, const NamedResult& folder,
                           const IsResultName& is_result);

}  // namespace posemix
