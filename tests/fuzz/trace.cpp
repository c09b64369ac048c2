// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "fetch/paths.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/results/report.hpp"
#include "posemix/results/trace_tracks.hpp"
#include "results/report_parts.hpp"
#include "results/small_results.hpp"
#include "target.hpp"

/// Folders of results with one file of the bytes, by the first letter: a trace, alone or beside
/// another run, stamps of pictures, or a document of a study, of consistency or with a mixture. Or
/// all files of a folder are in the bytes, of one run or of several that are compared. A report of
/// it is text.
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

/// The report of a mixture in a folder, and of its file alone.
void report_of_mixture(std::string_view text) {
  static const TemporaryFolder folder;
  report_with(folder, "mug.json", text);
  takes(folder.path().string(),
        [&] { expect(!format_report(folder / "mug.json").empty(), "a report without text"); });
}

/// A folder of few files: a line "=> PATH" begins each.
class FilesOfText : public TemporaryFolder {
 public:
  explicit FilesOfText(std::string_view text) {
    constexpr std::string_view kBegin = "=> ";
    for (std::size_t at = text.find(kBegin); at != text.npos && paths_.size() < kMostFiles;) {
      const std::size_t next = text.find("\n" + std::string(kBegin), at);
      put_file(text.substr(at + kBegin.size(), next - at - kBegin.size()));
      at = next == text.npos ? next : next + 1;
    }
  }
  /// In their order.
  const std::vector<std::filesystem::path>& paths() const { return paths_; }

 private:
  /// Its path, the end of the line, and its content.
  void put_file(std::string_view text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view name = text.substr(0, std::min(end, kMostLetters));
    if (!is_inner_path(name)) return;
    try {
      paths_.push_back(put(name, text.substr(std::min(end + 1, text.size()))));
    } catch (const std::filesystem::filesystem_error&) {
      // A folder of the name of a file.
    }
  }

  static constexpr std::size_t kMostFiles = 12;
  static constexpr std::size_t kMostLetters = 100;
  std::vector<std::filesystem::path> paths_;
};

/// Of a run with its pictures, and with meshes of objects of the names of their files.
void report_of_files(std::string_view text) {
  const FilesOfText folder(text);
  ReportOptions options{.warn = [](const std::string&) {}};
  for (const std::filesystem::path& path : folder.paths())
    if (path.extension() == ".ply") options.meshes[path.stem().string()] = {path, 1e-3};
  if (std::filesystem::exists(folder / "trace.json") &&
      std::filesystem::is_directory(folder / "pictures"))
    options.images = ReportImages{.folder = folder / "pictures", .most_bytes = 60};
  takes(folder.path().string(),
        [&] { expect(!format_report(folder.path(), options).empty(), "a report without text"); });
}

/// Of the folders of the files; of a file that is in none itself.
void comparison_of_files(std::string_view text) {
  const FilesOfText folder(text);
  std::vector<std::filesystem::path> runs;
  for (const std::filesystem::path& path : folder.paths()) {
    const auto run = path.parent_path() == folder.path() ? path : path.parent_path();
    if (std::find(runs.begin(), runs.end(), run) == runs.end()) runs.push_back(run);
  }
  takes(runs.size() < 2 ? "got " : folder.path().string(),
        [&] { expect(!format_comparison(runs).empty(), "a comparison without text"); });
  takes("got ", [&] {
    const auto parent = internal::common_parent(runs);
    for (const auto& run : runs) expect(run.parent_path() == parent, "a run of another folder");
  });
}

}  // namespace

POSEMIX_FUZZ_TARGET(trace) {
  const Choice choice(bytes);
  static const TemporaryFolder study;
  static const TemporaryFolder consistency;
  switch (choice.letter) {
    case 's':
      return report_with(study, "study.json", choice.rest);
    case 'c':
      return report_with(consistency, "consistency.json", choice.rest);
    case 'm':
      return report_of_mixture(choice.rest);
    case 'f':
      return report_of_files(choice.rest);
    case 'k':
      return comparison_of_files(choice.rest);
    case 'b':
      return comparison_with(choice.rest);
    case 'i':
      return pictures_with(choice.rest);
    default:
      return report_of_trace(choice.rest);
  }
}

}  // namespace posemix::fuzzing
