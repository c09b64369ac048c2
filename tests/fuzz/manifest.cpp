// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "fetch/fetch.hpp"
#include "fetch/lock_file.hpp"
#include "fetch/paths.hpp"
#include "fetch/sources.hpp"
#include "target.hpp"

/// What `posemix data` reads before it downloads, by the first letter: a registry of sources, a
/// manifest of sums, a lock file, a pointer of Git LFS. No path leads out of the folder, and what
/// is written is read again alike.
namespace posemix::fuzzing {
namespace {

constexpr std::string_view kRegistry =
    "schema = 1\n[[sources]]\nname = \"a\"\ntitle = \"t\"\nlicence = \"l\"\n"
    "base_url = \"https://example.org/\"\nmanifest = \"m\"\n";

void read_registry(std::string_view registry, std::string_view manifest, const std::string& name) {
  takes(name, [&] {
    const auto sources = parse_sources(TomlDocument::parse(registry, "f"),
                                       [&](const std::string&) { return std::string(manifest); });
    for (const DataSource& source : sources) {
      expect(!source.name.empty() && source.name.front() != '.', "a name that is no folder's");
      for (const SourceFile& file : source.files) {
        expect(is_inner_path(file.path), "a path that leads out");
        expect(file.strip.empty() || is_inner_path(file.strip), "a folder that leads out");
        expect(source.url_of(file).starts_with(source.base_url), "an address elsewhere");
      }
    }
  });
}

}  // namespace

POSEMIX_FUZZ_TARGET(manifest) {
  const Choice choice(bytes);
  switch (choice.letter) {
    case 'm':
      return read_registry(kRegistry, choice.rest, "");
    case 'l':
      takes("f", [&, text = choice.rest] {
        const LockFile lock = parse_lock_file(text, "f");
        for (const auto& [path, entry] : lock.files)
          expect(is_inner_path(path), "a path that leads out");
        const std::string written = format_lock_file(lock);
        expect(format_lock_file(parse_lock_file(written, "again")) == written,
               "another lock file after writing");
      });
      return;
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
