// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <optional>
#include <string>

#include "io/temporary_folder.hpp"
#include "posemix/results/report.hpp"
#include "posemix/results/trace_tracks.hpp"
#include "results/small_results.hpp"
#include "target.hpp"

/// Folders of results with one file of the bytes, by the first letter: a trace, alone or beside
/// another run, stamps of pictures, or a document of a study, of consistency or with a mixture. A
/// report of it is text.
namespace posemix::fuzzing {
namespace {

using posemix::testing::TemporaryFolder;

/// The report of a folder in which only this file changes.
void report_with(const TemporaryFolder& folder, const char* name, std::string_view text,
                 std::optional<ReportCamera> camera = std::nullopt) {
  folder.put(name, text);
  const ReportOptions options{.camera = camera,
                              .title = "a title",
                              .progress = [](std::size_t, std::size_t) {},
                              .warn = [](const std::string&) {}};
  takes(folder.path().string(),
        [&] { expect(!format_report(folder.path(), options).empty(), "a report without text"); });
}

void report_of_trace(std::string_view text) {
  static const TemporaryFolder folder;
  static const std::filesystem::path metrics = folder.put("metrics.json", "{}");
  report_with(folder, "trace.json", text, ReportCamera{500, 500, 320, 240, 640, 480});
  takes(folder.path().string(), [&] {
    for (const TraceTrack& track : read_trace_tracks(folder / "trace.json"))
      expect(!track.estimates.empty(), "a track without estimates");
  });
}

/// A folder with a run over the small recording.
void put_run(const TemporaryFolder& folder, const std::string& name) {
  for (const auto& [file, text] : testing::results().files) folder.put(name + "/" + file, text);
}

struct TwoRuns : TemporaryFolder {
  TwoRuns() {
    put_run(*this, "a");
    put("b/metrics.json", "{}");
  }
};

void comparison_with(std::string_view trace) {
  static const TwoRuns folder;
  // Without any the run is compared with itself.
  folder.put("b/trace.json", trace.empty() ? testing::results().files.at("trace.json") : trace);
  takes(folder.path().string(), [&] {
    expect(!format_comparison({folder / "a", folder / "b"}).empty(), "a comparison without text");
  });
}

struct RunWithPictures : TemporaryFolder {
  RunWithPictures() {
    put_run(*this, "run");
    for (const char* name : {"0.1.jpg", "1500000000000000000.JPEG", "left-0.5.png"})
      put(std::string("pictures/") + name, "\x89PNG\r\n\x1a\n and what follows");
    put("pictures/0.2.jpg", "\xff\xd8\xff and what follows");
  }
};

void pictures_with(std::string_view stamps) {
  static const RunWithPictures folder;
  // Without them those in the names count.
  if (stamps.empty()) std::filesystem::remove(folder / "pictures/stamps.csv");
  if (!stamps.empty()) folder.put("pictures/stamps.csv", stamps);
  takes(folder.path().string(), [&] {
    const ReportImages images{.folder = folder / "pictures", .most_bytes = 60};
    expect(!format_report(folder / "run", {.images = images}).empty(), "a report without text");
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
    case 'b':
      return comparison_with(choice.rest);
    case 'i':
      return pictures_with(choice.rest);
    default:
      return report_of_trace(choice.rest);
  }
}

}  // namespace posemix::fuzzing
