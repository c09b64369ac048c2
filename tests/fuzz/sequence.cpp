// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "config/small_recording.hpp"
#include "results/bounded_run.hpp"
#include "target.hpp"

/// Sequence files over a small recording, then the first frames of `posemix slam` by them and its
/// results.
namespace posemix::fuzzing {
namespace {

constexpr std::size_t kMostFrames = 3;

}  // namespace

POSEMIX_FUZZ_TARGET(sequence) {
  static const posemix::testing::SmallFolder small;
  takes("", [&] {
    posemix::testing::run_first_frames(TomlDocument::parse(bytes, "s.toml"), small.folder.path(),
                                       kMostFrames);
  });
}

}  // namespace posemix::fuzzing
