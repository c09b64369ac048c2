// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "fetch/sources.hpp"

/// Functions that the subcommands of `data` share.
namespace posemix {

void add_registry_option(CLI::App& command, std::optional<std::string>& registry);

/// The sources of the registry file, followed by those of the program; without a file those of the
/// program.
std::vector<DataSource> known_sources(const std::optional<std::string>& registry);

/// A size as text, such as "825 MB", "15.0 GB" or "800 B".
std::string format_bytes(std::uint64_t bytes);

/// A number of files as text, such as "4600 files", with the sum of their sizes if all are known.
std::string format_amount(const std::vector<SourceFile>& files);

}  // namespace posemix
