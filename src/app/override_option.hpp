// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

/// The option --set KEY=VALUE of the commands that read settings.
namespace posemix {

/// Adds --set, which may be given for several keys. What another --set would replace is refused.
CLI::Option* add_override_option(CLI::App& command, std::vector<std::string>& overrides,
                                 const std::string& help);

/// The first override of the key `a.b`; null if there is none.
const std::string* find_override(const std::vector<std::string>& overrides, const std::string& key);

}  // namespace posemix
