// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "sources.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "built_in.hpp"
#include "paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

constexpr std::int64_t kRegistrySchema = 1;
constexpr std::string_view kLetters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";

std::string percent_encoded(std::string_view path) {
  std::string encoded;
  for (const char c : path) {
    const bool kept = kLetters.find(c) != std::string_view::npos || c == '/' || c == '~';
    encoded += kept ? std::string(1, c)
                    : fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
  }
  return encoded;
}

/// Whether there is a space or a control character, at which a message or the transfer would end.
bool has_space(std::string_view url) {
  return std::any_of(url.begin(), url.end(),
                     [](unsigned char c) { return c <= 0x20 || c == 0x7f; });
}

std::string read_address(const TomlTable& source, std::string_view key) {
  std::string url = source.get_string(key);
  if (has_space(url) || (!url.starts_with("https://") && !url.starts_with("http://")))
    source.fail(key, fmt::format("is {}, expected an address https://...", in_quotes(url, 200)));
  if (!url.ends_with('/')) url += '/';
  return url;
}

std::string read_source_name(const TomlTable& source) {
  std::string name = source.get_string("name");
  const bool fits = !name.empty() && name.size() <= 100 && name.front() != '.' &&
                    name.find_first_not_of(kLetters) == std::string::npos;
  if (!fits) {
    source.fail("name", fmt::format("is {}, expected 1 to 100 letters, digits, '_', '.' and '-', "
                                    "no '.' first",
                                    in_quotes(name)));
  }
  return name;
}

SourceFile read_file_entry(const TomlTable& table, bool has_pointers) {
  SourceFile file;
  file.path = table.get_string("path");
  if (!is_inner_path(file.path))
    table.fail("path", fmt::format("is {}, expected a path below the source's folder",
                                   in_quotes(file.path, 200)));
  if (table.has("size"))
    file.size = static_cast<std::uint64_t>(table.get_integer("size", kAtLeastZero));
  file.sha256 = table.get_string_or("sha256", "");
  if (!file.sha256.empty() && !is_sha256(file.sha256))
    table.fail("sha256", fmt::format("is {}, expected 64 hexadecimal digits in lower case",
                                     in_quotes(file.sha256, 100)));
  file.published = table.get_bool_or("published", false);
  if (file.published && !has_pointers)
    table.fail("published", "is true, but the source has no 'published_url'");
  file.optional = table.get_bool_or("optional", false);
  file.strip = table.get_string_or("strip", "");
  if (!file.strip.empty() && !is_inner_path(file.strip))
    table.fail("strip", "is no path of a folder");
  return file;
}

std::vector<SourceFile> parse_manifest(std::string_view text, const std::string& name) {
  std::vector<SourceFile> files;
  LineReader reader(text, name);
  while (reader.next_content()) {
    const std::string_view line = reader.line();
    // A file of an unknown sum has a dash for it.
    const std::size_t digits = line.starts_with('-') ? 1 : 64;
    const bool fits = line.size() > digits + 2 && line[digits] == ' ' &&
                      (line[digits + 1] == ' ' || line[digits + 1] == '*') &&
                      (digits == 1 || is_sha256(line.substr(0, digits)));
    if (!fits) reader.fail(in_quotes(line, 100), "a line 'SHA-256  path'");
    SourceFile file;
    if (digits > 1) file.sha256 = line.substr(0, digits);
    file.path = line.substr(digits + 2);
    if (!is_inner_path(file.path))
      reader.fail(fmt::format("the path {}", in_quotes(file.path, 100)),
                  "one below the source's folder");
    files.push_back(std::move(file));
  }
  return files;
}

std::vector<SourceFile> read_files(const TomlTable& source, bool has_pointers,
                                   const ManifestReader& manifest) {
  std::vector<SourceFile> files;
  if (source.has("manifest")) {
    const std::string name = source.get_string("manifest");
    if (!is_inner_path(name)) source.fail("manifest", "is no path beside the registry");
    files = parse_manifest(manifest(name), name);
  }
  for (const TomlTable& table : source.find_tables("files"))
    files.push_back(read_file_entry(table, has_pointers));
  if (files.empty()) source.fail("files", "is missing or empty, and so is 'manifest'");
  std::set<std::string_view> paths;
  for (const SourceFile& file : files) {
    if (!paths.insert(file.path).second)
      source.fail("files", fmt::format("has {} twice", in_quotes(file.path, 200)));
  }
  return files;
}

DataSource read_source(const TomlTable& table, const ManifestReader& manifest) {
  DataSource source;
  source.name = read_source_name(table);
  source.title = table.get_string("title");
  source.homepage = table.get_string_or("homepage", "");
  source.revision = table.get_string_or("revision", "");
  source.licence = table.get_string("licence");
  source.licence_url = table.get_string_or("licence_url", "");
  source.copyright = table.get_string_or("copyright", "");
  source.hashes = table.get_string_or("hashes", "");
  source.use = table.get_string_or("use", "");
  source.base_url = read_address(table, "base_url");
  if (table.has("published_url")) source.published_url = read_address(table, "published_url");
  source.files = read_files(table, !source.published_url.empty(), manifest);
  return source;
}

}  // namespace

std::string DataSource::url_of(const SourceFile& file) const {
  return base_url + percent_encoded(file.path);
}

std::string DataSource::published_url_of(const SourceFile& file) const {
  return published_url + percent_encoded(file.path);
}

std::vector<DataSource> parse_sources(const TomlDocument& registry,
                                      const ManifestReader& manifest) {
  const TomlTable root = registry.root();
  const std::int64_t schema = root.get_integer("schema");
  if (schema != kRegistrySchema)
    root.fail("schema", fmt::format("is {}, expected {}", schema, kRegistrySchema));
  std::vector<DataSource> sources;
  std::set<std::string> names;
  for (const TomlTable& table : root.get_tables("sources")) {
    sources.push_back(read_source(table, manifest));
    if (!names.insert(sources.back().name).second)
      table.fail("name",
                 fmt::format("is {}, as that of another source", in_quotes(sources.back().name)));
  }
  registry.finish();
  return sources;
}

std::vector<DataSource> read_sources(const std::filesystem::path& registry) {
  return parse_sources(TomlDocument::load(registry), [&](const std::string& name) {
    return read_file(registry.parent_path() / name);
  });
}

std::vector<DataSource> built_in_sources() {
  const TomlDocument registry = TomlDocument::parse(kBuiltInRegistry, "data/sources/sources.toml");
  return parse_sources(registry, [](const std::string& name) {
    for (const BuiltInManifest& manifest : built_in_manifests())
      if (manifest.name == name) return std::string(manifest.text);
    throw InvalidInput(name + ": is no manifest of this program");
  });
}

const DataSource& find_source(const std::vector<DataSource>& sources, std::string_view name) {
  std::vector<std::string> names;
  for (const DataSource& source : sources) {
    if (source.name == name) return source;
    names.push_back(source.name);
  }
  throw InvalidInput(
      fmt::format("{} is no source of data, expected one of {}; see `posemix data "
                  "list`",
                  in_quotes(name), fmt::join(names, ", ")));
}

bool is_sha256(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

void check_url(const std::string& url, bool allow_http) {
  constexpr std::string_view kHttp = "http://";
  if (has_space(url))
    throw InvalidInput(
        fmt::format("{}: got an address with a space or a control character, "
                    "expected one without",
                    in_quotes(url, 200)));
  if (url.starts_with("https://")) return;
  if (!url.starts_with(kHttp))
    throw InvalidInput(fmt::format("{}: got an address of another kind, expected https", url));
  std::string_view host = std::string_view(url).substr(kHttp.size());
  host = host.substr(0, host.find_first_of("/?#"));
  constexpr std::array<std::string_view, 3> kThisMachine{"localhost", "127.0.0.1", "[::1]"};
  const bool here = std::any_of(kThisMachine.begin(), kThisMachine.end(), [&](std::string_view at) {
    return host == at || (host.starts_with(at) && host[at.size()] == ':' &&
                          host.find_first_not_of("0123456789", at.size() + 1) == host.npos);
  });
  if (here || allow_http) return;
  throw InvalidInput(
      fmt::format("{}: got an address that is not encrypted, expected https (or "
                  "--allow-http)",
                  url));
}

}  // namespace posemix
