// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "report_folder.hpp"
#include "report_parts.hpp"
#include "run_files.hpp"

namespace posemix {
namespace {

using namespace internal;

namespace fs = std::filesystem;

/// Stamps closer than this are of the same frame [s].
constexpr double kSameFrameS = 1e-6;

/// What decides on whether runs can be compared.
struct ComparedRun {
  fs::path path;
  std::vector<double> stamps;
  std::set<std::string> objects;
};

/// The frames of two runs within the time that both cover.
struct CommonFrames {
  double from;
  double to;
  std::size_t both = 0;
  std::size_t one = 0;  ///< that one of them lacks
};

CommonFrames common_frames(const std::vector<double>& a, const std::vector<double>& b) {
  CommonFrames common{std::max(a.front(), b.front()) - kSameFrameS,
                      std::min(a.back(), b.back()) + kSameFrameS};
  const auto inside = [&](double stamp) { return stamp >= common.from && stamp <= common.to; };
  auto left = a.begin();
  auto right = b.begin();
  while (left != a.end() || right != b.end()) {
    const bool same =
        left != a.end() && right != b.end() && std::abs(*left - *right) <= kSameFrameS;
    const bool takes_left = left != a.end() && (right == b.end() || *left <= *right);
    const double stamp = same || takes_left ? *left : *right;
    if (inside(stamp)) ++(same ? common.both : common.one);
    if (same || takes_left) ++left;
    if (same || !takes_left) ++right;
  }
  return common;
}

void require_same_recording(const ComparedRun& first, const ComparedRun& other) {
  const std::string place = fmt::format("{} and {}", first.path.string(), other.path.string());
  const CommonFrames frames = common_frames(first.stamps, other.stamps);
  if (frames.both == 0) {
    throw InvalidInput(
        fmt::format("{}: got runs from {} to {} s and from {} to {} s without a frame in common, "
                    "expected runs over the same recording",
                    place, first.stamps.front(), first.stamps.back(), other.stamps.front(),
                    other.stamps.back()));
  }
  if (frames.one > 0) {
    throw InvalidInput(fmt::format(
        "{}: got {} frames that are in one of the runs alone beside {} in both, expected the same "
        "frames where both run, those of one recording",
        place, frames.one, frames.both));
  }
  const bool share = std::any_of(first.objects.begin(), first.objects.end(),
                                 [&](const auto& id) { return other.objects.contains(id); });
  if (share || (first.objects.empty() && other.objects.empty())) return;
  throw InvalidInput(fmt::format("{}: got runs of other objects, {} and {}, expected one in common",
                                 place, fmt::join(first.objects, ", "),
                                 fmt::join(other.objects, ", ")));
}

/// The names of the folders, with those above where they are alike.
std::vector<std::string> names_of(const std::vector<fs::path>& runs) {
  std::vector<std::string> names;
  names.reserve(runs.size());
  for (const fs::path& run : runs) names.push_back(last_name(run));
  if (std::set(names.begin(), names.end()).size() == names.size()) return names;
  names.clear();
  for (const fs::path& run : runs) {
    const fs::path parent =
        (absolute_path(run) / "").lexically_normal().parent_path().parent_path();
    names.push_back(fmt::format("{}/{}", last_name(parent), last_name(run)));
  }
  return names;
}

ReportFolder run_folder(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) {
    throw InvalidInput(fmt::format(
        "{}: is a file, expected a folder that posemix slam wrote, to be compared", path.string()));
  }
  ReportFolder folder = read_report_folder(path);
  if (folder.kind == ReportKind::slam) return folder;
  throw InvalidInput(fmt::format(
      "{}: got a folder without a run, expected what posemix slam wrote, to be compared",
      path.string()));
}

}  // namespace

std::string format_comparison(const std::vector<fs::path>& runs, const ReportOptions& options) {
  if (runs.size() < 2)
    throw InvalidInput(fmt::format("got {} runs, expected at least two to compare", runs.size()));
  const std::vector<std::string> names = names_of(runs);
  std::optional<ComparedRun> first;
  std::set<std::string> objects;
  Json list = Json::array();
  std::string recording;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    ReportFolder folder = run_folder(runs[i]);
    warn(folder.warnings, options);
    Json trace = read_packed_trace(runs[i], options);
    Json& metrics = folder.documents.at("metrics.json");
    require_one_run(trace, metrics, runs[i]);
    ComparedRun run{runs[i], trace.at("stamps_s").get<std::vector<double>>(),
                    trace.at("order").get<std::set<std::string>>()};
    objects.insert(run.objects.begin(), run.objects.end());
    if (first) {
      require_same_recording(*first, run);
    } else {
      recording = trace.at("name").get<std::string>();
      first = std::move(run);
    }
    list.push_back({{"name", names[i]},
                    {"trace", std::move(trace)},
                    {"documents", {{"metrics.json", std::move(metrics)}}}});
  }
  Json report =
      report_head(ReportKind::comparison,
                  options.title.value_or(fmt::format("{}: {} runs", recording, runs.size())));
  report["meshes"] = meshes_json(options, objects);
  for (const char* key : {"documents", "tables", "pictures", "texts"}) report[key] = Json::object();
  report["runs"] = std::move(list);
  if (options.images) report["images"] = images_json(options);
  return json_text(report);
}

}  // namespace posemix
