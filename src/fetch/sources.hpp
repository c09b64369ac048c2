// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/config/toml_table.hpp"

/// Where public data lies and how to know that it is what was meant.
namespace posemix {

/// One file of a source.
struct SourceFile {
  std::string path;  ///< below the source's address and its folder; with '/', never leading out
  std::optional<std::uint64_t> size;  ///< bytes, where known
  std::string sha256;                 ///< 64 hexadecimal digits; empty where the registry has none
  bool published = false;             ///< the host publishes a hash, as a Git LFS pointer
  bool optional = false;              ///< fetched only when it is named
  std::string strip;                  ///< leading folder that unpacking leaves out
};

/// A set of files at one address.
struct DataSource {
  std::string name;  ///< of the folder that they go to
  std::string title;
  std::string homepage;
  std::string revision;  ///< commit that the addresses name; may be empty
  std::string licence;
  std::string licence_url;
  std::string copyright;
  std::string hashes;         ///< where the hashes are from
  std::string use;            ///< a command that uses the data
  std::string base_url;       ///< ends in '/'
  std::string published_url;  ///< of the Git LFS pointers; ends in '/', may be empty
  std::vector<SourceFile> files;

  /// The address of a file: its path percent-encoded below base_url.
  std::string url_of(const SourceFile& file) const;
  std::string published_url_of(const SourceFile& file) const;
};

/// The text of a manifest that a registry names.
using ManifestReader = std::function<std::string(const std::string& name)>;

/// The sources of a registry (docs/data.md). A source's `manifest` is a file of lines
/// `SHA-256  path`, as sha256sum writes them.
/// @throws InvalidInput naming file, line and key or path
std::vector<DataSource> parse_sources(const TomlDocument& registry, const ManifestReader& manifest);

/// A registry file; manifests lie beside it.
std::vector<DataSource> read_sources(const std::filesystem::path& registry);

/// The sources that are part of the program.
std::vector<DataSource> built_in_sources();

/// The source of that name. @throws InvalidInput that lists the names
const DataSource& find_source(const std::vector<DataSource>& sources, std::string_view name);
const DataSource& find_source(std::vector<DataSource>&& sources, std::string_view name) = delete;

/// True for 64 lower-case hexadecimal digits.
bool is_sha256(std::string_view text);

/// Refuses addresses that are neither https nor, on this machine or where `allow_http` is set,
/// http. @throws InvalidInput
void check_url(const std::string& url, bool allow_http);

}  // namespace posemix
