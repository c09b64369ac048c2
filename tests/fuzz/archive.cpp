// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "fetch/unpack.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/io/output_folder.hpp"
#include "target.hpp"

/// Archives: files come to lie below the folder, and nothing else does anywhere. A name that cannot
/// be written is an OutputError. A budget of bytes stands for the disk.
namespace posemix::fuzzing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFiles = 16;

/// Everything that lies in a folder is a file or a folder. Of a file, which may be an archive in an
/// archive, the name says so whatever comes before its end.
void expect_plain(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::file_status status = entry.symlink_status();
    expect(fs::is_regular_file(status) || fs::is_directory(status), "a link or a device");
    const std::string name = entry.path().filename().string();
    expect(!is_archive_name(name) || is_archive_name("a" + name), "another kind of file");
  }
}

}  // namespace

POSEMIX_FUZZ_TARGET(archive) {
  static const posemix::testing::TemporaryFolder place;
  const Choice choice(bytes);
  const fs::path archive = place.put("a.zip", choice.rest);
  const fs::path inside = place / "outer/inner";
  fs::remove_all(place / "outer");
  fs::create_directories(inside);
  try {
    takes(archive.string(), [&, strip = choice.letter] {
      unpack_archive(archive, inside, strip == 's' ? "top" : "",
                     [](std::size_t files) { return files < kMostFiles; });
    });
  } catch (const OutputError& error) {
    expect(std::string_view(error.what()).starts_with(inside.string()), "an output elsewhere");
  }
  expect_plain(inside);
  for (const auto& entry : fs::directory_iterator(place / "outer"))
    expect(entry.path() == inside, "a file beside the folder");
}

}  // namespace posemix::fuzzing
