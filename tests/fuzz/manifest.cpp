// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include "fetch/fetch.hpp"
#include "fetch/lock_file.hpp"
#include "fetch/paths.hpp"
#include "fetch/sources.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/io/text.hpp"
#include "target.hpp"

/// What `posemix data` reads before it downloads, by the first letter: a registry of sources, as
/// text or as a file, a manifest of sums, a lock file, a pointer of Git LFS, the name of a source,
/// an address, and patterns of files. No path leads out of the folder, and what is written is read
/// again alike.
namespace posemix::fuzzing {
namespace {

using posemix::testing::TemporaryFolder;

constexpr std::string_view kRegistry =
    "schema = 1\n[[sources]]\nname = \"a\"\ntitle = \"t\"\nlicence = \"l\"\n"
    "base_url = \"https://example.org/\"\nmanifest = \"m\"\n";

void expect_inside(const std::vector<DataSource>& sources) {
  for (const DataSource& source : sources) {
    expect(!source.name.empty() && source.name.front() != '.', "a name that is no folder's");
    expect(&find_source(sources, source.name) == &source, "a source that is not found");
    for (const SourceFile& file : source.files) {
      expect(is_inner_path(file.path), "a path that leads out");
      expect(file.strip.empty() || is_inner_path(file.strip), "a folder that leads out");
      expect(source.url_of(file).starts_with(source.base_url), "an address elsewhere");
      expect(source.published_url_of(file).starts_with(source.published_url),
             "an address of a sum elsewhere");
    }
  }
}

void read_registry(std::string_view registry, std::string_view manifest, const std::string& name) {
  takes(name, [&] {
    expect_inside(parse_sources(TomlDocument::parse(registry, "f"),
                                [&](const std::string&) { return std::string(manifest); }));
  });
}

/// As a file, beside the manifests that it may name.
void read_registry_file(std::string_view registry) {
  static const TemporaryFolder folder;
  static const auto manifest = folder.put("m", "-  a\n");
  const auto path = folder.put("sources.toml", registry);
  // A manifest that is not there is named by its own path.
  takes(folder.path().string(), [&] { expect_inside(read_sources(path)); });
}

void read_lock(std::string_view text) {
  static const TemporaryFolder folder;
  takes("f", [&] {
    const LockFile lock = parse_lock_file(text, "f");
    for (const auto& [path, entry] : lock.files)
      expect(is_inner_path(path), "a path that leads out");
    const std::string written = format_lock_file(lock);
    expect(format_lock_file(parse_lock_file(written, "again")) == written,
           "another lock file after writing");
    folder.put(kLockFileName, written);
    expect(format_lock_file(read_lock_file(folder.path())) == written,
           "another lock file in the folder");
  });
}

void find_built_in(std::string_view name) {
  static const std::vector<DataSource> sources = built_in_sources();
  takes("\"", [&] { expect(find_source(sources, name).name == name, "another source"); });
}

/// An address; one with a space or a control character is refused in quotes.
void read_url(std::string_view text) {
  const std::string url(text);
  const bool is_plain =
      std::none_of(url.begin(), url.end(), [](unsigned char c) { return c <= 0x20 || c == 0x7f; });
  const std::string begins = is_plain ? url : "\"";
  const bool is_taken_with_http = takes(begins, [&] { check_url(url, true); });
  expect(!is_taken_with_http || is_plain, "an address with a control character");
  const bool is_taken = takes(begins, [&] { check_url(url, false); });
  expect(!is_taken || url.starts_with("https://") || url.starts_with("http://localhost") ||
             url.starts_with("http://127.0.0.1") || url.starts_with("http://[::1]"),
         "an address that is not encrypted");
}

/// A pattern in the first line, names in the others.
void match(std::string_view text) {
  const auto lines = split_fields(text, '\n');
  const std::string_view pattern = lines.front();
  const auto stars = std::count(pattern.begin(), pattern.end(), '*');
  expect(matches_pattern(pattern, pattern), "a pattern that does not match itself");
  for (const std::string_view name : lines) {
    const bool matches = matches_pattern(name, pattern);
    expect(matches_pattern(name, "*"), "a star that does not stand for all");
    expect(stars > 0 || matches == (name == pattern), "a name that is none of the pattern");
    expect(!matches || matches_pattern("a" + std::string(name), "*" + std::string(pattern)),
           "a star that does not stand for a letter");
  }
}

}  // namespace

POSEMIX_FUZZ_TARGET(manifest) {
  const Choice choice(bytes);
  switch (choice.letter) {
    case 'm':
      return read_registry(kRegistry, choice.rest, "");
    case 'f':
      return read_registry_file(choice.rest);
    case 'l':
      return read_lock(choice.rest);
    case 'n':
      return find_built_in(choice.rest);
    case 'u':
      return read_url(choice.rest);
    case '*':
      return match(choice.rest);
    case 'p':
      takes("f", [&, text = choice.rest] {
        expect(is_sha256(parse_lfs_pointer(text, "f").sha256), "a sum that is none");
      });
      return;
    default:
      return read_registry(choice.rest, "-  a\n", "f");
  }
}

}  // namespace posemix::fuzzing
