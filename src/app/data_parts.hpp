// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "fetch/sources.hpp"

/// What the commands of `data` share.
namespace posemix {

void add_registry_option(CLI::App& command, std::optional<std::string>& registry);

/// The sources of the registry file, before those of the program; the program's alone without one.
std::vector<DataSource> known_sources(const std::optional<std::string>& registry);

/// "825 MB", "15.0 GB", "800 B".
std::string format_bytes(std::uint64_t bytes);

/// "4600 files", with the sum of the sizes where all are known.
std::string format_amount(const std::vector<SourceFile>& files);

}  // namespace posemix
