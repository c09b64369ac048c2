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

/// The registry of public data: addresses, and hashes by which fetched files are verified.
namespace posemix {

/// One file of a source.
struct SourceFile {
  std::string path;  ///< relative to the source's address and to its folder, with '/'; never leads
                     ///< out of it
  std::optional<std::uint64_t> size;  ///< [bytes], if known
  std::string sha256;                 ///< 64 hexadecimal digits; empty where the registry has none
  bool published = false;             ///< the host publishes a hash, as a Git LFS pointer
  bool optional = false;              ///< fetched only when it is named
  std::string strip;                  ///< leading folder that unpacking removes
};

/// A set of files at one address.
struct DataSource {
  std::string name;  ///< also the name of the folder for the files
  std::string title;
  std::string homepage;
  std::string revision;  ///< commit that the addresses name; may be empty
  std::string licence;
  std::string licence_url;
  std::string copyright;
  std::string hashes;         ///< origin of the hashes
  std::string use;            ///< a command that uses the data
  std::string base_url;       ///< ends in '/'
  std::string published_url;  ///< address of the Git LFS pointers; ends in '/', may be empty
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

/// Reads a registry file, with the manifests beside it.
std::vector<DataSource> read_sources(const std::filesystem::path& registry);

/// The sources that are part of the program.
std::vector<DataSource> built_in_sources();

/// The source of that name.
/// @throws InvalidInput that lists the known names
const DataSource& find_source(const std::vector<DataSource>& sources, std::string_view name);
const DataSource& find_source(std::vector<DataSource>&& sources, std::string_view name) = delete;

/// True for 64 lower-case hexadecimal digits.
bool is_sha256(std::string_view text);

/// Checks an address: https, or http if it is on this machine or `allow_http` is set.
/// @throws InvalidInput for any other address
void check_url(const std::string& url, bool allow_http);

}  // namespace posemix
