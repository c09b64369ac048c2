// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string_view>

namespace posemix {

/// A manifest that is part of the program.
struct BuiltInManifest {
  std::string_view name;
  std::string_view text;
};

/// data/sources/sources.toml and the manifests that it names.
extern const std::string_view kBuiltInRegistry;
std::span<const BuiltInManifest> built_in_manifests();

}  // namespace posemix
