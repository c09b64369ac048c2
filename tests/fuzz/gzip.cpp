// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/gzip.hpp"
#include "io/temporary_folder.hpp"
#include "target.hpp"

/// Files that may be compressed by gzip: what is read is compressed and read again alike.
namespace posemix::fuzzing {

POSEMIX_FUZZ_TARGET(gzip) {
  static const posemix::testing::TemporaryFolder folder;
  const auto path = folder.put("f.gz", bytes);
  takes(path.string(), [&] {
    const std::string text = read_file_or_gzip(path);
    const auto again = folder.put("again.gz", posemix::gzip(text));
    expect(read_file_or_gzip(again) == text, "another text after writing");
  });
}

}  // namespace posemix::fuzzing
