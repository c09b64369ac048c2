// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "io/temporary_folder.hpp"
#include "posemix/results/report.hpp"
#include "posemix/results/trace_tracks.hpp"
#include "target.hpp"

/// Folders of results with one file of the bytes, by the first letter: a trace, a table of tracks,
/// or a document of a study, of consistency or with a mixture. A report of it is text.
namespace posemix::fuzzing {
namespace {

using posemix::testing::TemporaryFolder;

/// The report of a folder in which only this file changes.
void report_with(const TemporaryFolder& folder, const char* name, std::string_view text) {
  folder.put(name, text);
  takes(folder.path().string(),
        [&] { expect(!format_report(folder.path()).empty(), "a report without text"); });
}

void report_of_trace(std::string_view text) {
  static const TemporaryFolder folder;
  static const std::filesystem::path metrics = folder.put("metrics.json", "{}");
  report_with(folder, "trace.json", text);
  takes(folder.path().string(), [&] {
    for (const TraceTrack& track : read_trace_tracks(folder / "trace.json"))
      expect(!track.estimates.empty(), "a track without estimates");
  });
}

}  // namespace

POSEMIX_FUZZ_TARGET(trace) {
  const Choice choice(bytes);
  static const TemporaryFolder study;
  static const TemporaryFolder consistency;
  static const TemporaryFolder mixtures;
  switch (choice.letter) {
    case 's':
      return report_with(study, "study.json", choice.rest);
    case 'c':
      return report_with(consistency, "consistency.json", choice.rest);
    case 'm':
      return report_with(mixtures, "mug.json", choice.rest);
    default:
      return report_of_trace(choice.rest);
  }
}

}  // namespace posemix::fuzzing
