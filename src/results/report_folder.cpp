// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report_folder.hpp"

#include <algorithm>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/json_fault.hpp"
#include "io/sha256.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/io/text.hpp"
#include "run_files.hpp"

namespace posemix::internal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTraceFile = "trace.json";
constexpr const char* kMetricsFile = "metrics.json";
constexpr const char* kStudyFile = "study.json";
constexpr const char* kPosteriorFile = "posterior.json";
constexpr const char* kCamerasFile = "cameras.csv";

[[noreturn]] void fail_to_list(const fs::path& folder, const std::error_code& error) {
  throw InvalidInput(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
}

/// The entries of a folder, sorted.
std::vector<fs::path> paths_in(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> paths;
  fs::directory_iterator at(folder, error);
  for (; !error && at != fs::directory_iterator(); at.increment(error)) paths.push_back(at->path());
  if (error) fail_to_list(folder, error);
  std::sort(paths.begin(), paths.end());
  return paths;
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool has_results(const fs::path& folder) {
  return is_file(folder / kTraceFile) || is_file(folder / kStudyFile) ||
         is_file(folder / kConsistencyFile);
}

Json parse_document(const std::string& text, const fs::path& path) {
  return json_of(text, path.string(), "JSON as posemix writes it");
}

Json read_document(const fs::path& path) { return parse_document(read_file(path), path); }

bool is_mixture(const Json& document) {
  if (!document.is_object()) return false;
  const auto type = document.find("type");
  return type != document.end() && *type == "posemix.mixture";
}

/// Refuses a mixture file that the library does not read.
void check_mixture(const Json& document, const fs::path& path, ReportFolder& folder) {
  if (!is_mixture(document)) return;
  const MixtureFile file = parse_mixture(document.dump(), path.string());
  folder.warnings.insert(folder.warnings.end(), file.warnings.begin(), file.warnings.end());
}

/// Reads the files that a report shows from a folder that slam or study wrote.
void add_file(ReportFolder& folder, const fs::path& path) {
  const std::string name = path.filename().string();
  const std::string extension = path.extension().string();
  if (extension == ".json" && name != kTraceFile) {
    const std::string text = read_file(path);
    Json document = parse_document(text, path);
    check_mixture(document, path, folder);
    if (is_mixture(document) || name == kPosteriorFile) folder.digests[name] = sha256_of(text);
    folder.documents[name] = std::move(document);
  } else if (extension == ".csv") {
    const std::string text = read_file(path);
    if (name == kCamerasFile) folder.digests[name] = sha256_of(text);
    folder.tables[name] = text;
  } else if (extension == ".svg") {
    folder.pictures[name] = read_file(path);
  } else if (extension == ".md") {
    folder.texts[name] = read_file(path);
  }
}

/// Reads the mixtures of a folder that may also have other files.
void add_mixture(ReportFolder& folder, const fs::path& path) {
  if (path.extension() != ".json") return;
  Json document = read_document(path);
  check_mixture(document, path, folder);
  if (is_mixture(document)) folder.documents[path.filename().string()] = std::move(document);
}

[[noreturn]] void fail_without_results(const fs::path& folder) {
  std::vector<std::string> within;
  for (const fs::path& path : paths_in(folder)) {
    if (has_results(path)) within.push_back(path.string());
  }
  const std::string expected =
      within.empty()
          ? "what posemix slam, study or consistency wrote, or mixture files"
          : fmt::format("one of the folders within that have some: {}", fmt::join(within, ", "));
  throw InvalidInput(
      fmt::format("{}: got a folder without results, expected {}", folder.string(), expected));
}

ReportKind study_kind(const Json& study, const fs::path& path) {
  const auto name = study.is_object() ? study.find("study") : study.end();
  if (name == study.end() || !name->is_string()) {
    throw InvalidInput(
        fmt::format("{}: got no key 'study', expected the study's name", path.string()));
  }
  return *name == "salt-box" ? ReportKind::salt_box : ReportKind::study;
}

void check_consistency(const Json& document, const fs::path& path) {
  const bool has_title = document.is_object() && document.contains("title") &&
                         document.at("title").is_string() && document.contains("poses") &&
                         document.at("poses").is_array();
  if (has_title) return;
  throw InvalidInput(
      fmt::format("{}: got no keys 'title' and 'poses', expected what posemix consistency wrote",
                  path.string()));
}

ReportKind kind_of(const ReportFolder& folder, const fs::path& path) {
  if (is_file(path / kTraceFile)) {
    if (!folder.documents.contains(kMetricsFile)) read_file(path / kMetricsFile);
    return ReportKind::slam;
  }
  const auto study = folder.documents.find(kStudyFile);
  if (study != folder.documents.end()) return study_kind(*study, path / kStudyFile);
  const auto consistency = folder.documents.find(kConsistencyFile);
  if (consistency != folder.documents.end()) {
    check_consistency(*consistency, path / kConsistencyFile);
    return ReportKind::consistency;
  }
  if (folder.documents.empty()) fail_without_results(path);
  return ReportKind::mixture;
}

/// Leaves out the files of a study that was written beside a run: a report never mixes the two.
void leave_out_study(ReportFolder& folder, const fs::path& path) {
  const auto study = folder.documents.find(kStudyFile);
  if (study == folder.documents.end()) return;
  folder.warnings.push_back(
      fmt::format("{}: is left out with its files, as the folder has a run too, which is shown",
                  (path / kStudyFile).string()));
  std::vector<std::string> names{kStudyFile};
  const auto files = study->is_object() ? study->find("files") : study->end();
  if (files != study->end() && files->is_array()) {
    for (const Json& name : *files)
      if (name.is_string()) names.push_back(name.get<std::string>());
  }
  for (const std::string& name : names) {
    folder.documents.erase(name);
    folder.tables.erase(name);
    folder.pictures.erase(name);
    folder.texts.erase(name);
  }
}

ReportFolder one_mixture(const fs::path& path) {
  ReportFolder folder;
  folder.kind = ReportKind::mixture;
  folder.warnings = parse_mixture(read_file(path), path.string()).warnings;
  folder.documents[path.filename().string()] = read_document(path);
  return folder;
}

}  // namespace

std::set<std::string> ReportFolder::mixture_frames() const {
  std::set<std::string> names;
  for (const Json& document : documents) {
    if (is_mixture(document)) names.insert(document.at("frames").at("to").get<std::string>());
  }
  return names;
}

ReportFolder read_report_folder(const fs::path& results) {
  if (is_file(results)) return one_mixture(results);
  ReportFolder folder;
  const auto add = has_results(results) ? add_file : add_mixture;
  for (const fs::path& path : paths_in(results)) {
    if (is_file(path)) add(folder, path);
  }
  folder.kind = kind_of(folder, results);
  if (folder.kind == ReportKind::slam) {
    leave_out_study(folder, results);
    keep_files_of_run(folder, results, kMetricsFile);
  }
  return folder;
}

std::vector<fs::path> runs_in(const fs::path& folder) {
  std::vector<fs::path> runs;
  for (const fs::path& path : paths_in(folder)) {
    if (is_file(path / kTraceFile) && is_file(path / kMetricsFile)) runs.push_back(path);
  }
  return runs;
}

bool holds_runs(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error) || has_results(folder)) return false;
  const std::vector<fs::path> paths = paths_in(folder);
  const bool has_documents = std::any_of(paths.begin(), paths.end(), [](const fs::path& path) {
    return path.extension() == ".json" && is_file(path);
  });
  return !has_documents && runs_in(folder).size() > 1;
}

}  // namespace posemix::internal
