// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run_files.hpp"

#include <fmt/format.h>

#include "io/renamed.hpp"
#include "posemix/base/error.hpp"

namespace posemix::internal {
namespace {

constexpr std::string_view kPrefix = "mixture_";
constexpr std::string_view kExtension = ".json";

/// The id in the name of a mixture file of a run.
std::string id_in(const std::string& name) {
  const bool fits = name.size() > kPrefix.size() + kExtension.size() && name.starts_with(kPrefix) &&
                    name.ends_with(kExtension);
  return fits ? name.substr(kPrefix.size(), name.size() - kPrefix.size() - kExtension.size()) : "";
}

/// Whether a run of an earlier version, which does not list its files, wrote none of this name: a
/// filter without hypotheses of every object for itself has no probability of a mode.
bool is_of_other_filter(const std::string& name, const Json& metrics) {
  const auto objects = metrics.find("objects");
  if (objects == metrics.end() || !objects->is_object()) return false;
  const auto object = objects->find(id_in(name));
  if (object == objects->end() || !object->is_object()) return false;
  return object->value("mode_probability", Json()).is_null();
}

bool belongs(const std::string& name, const std::string& digest, const Json& metrics) {
  const auto files = metrics.find("files");
  if (files == metrics.end() || !files->is_object()) return !is_of_other_filter(name, metrics);
  return files->value(name, Json()) == digest;
}

/// "gated" was what "unexplained" is now, and stands for less since then.
void rename_gated(Json& metrics, const std::filesystem::path& path, ReportFolder& folder) {
  const auto objects = metrics.find("objects");
  if (objects == metrics.end() || !objects->is_object()) return;
  bool any = false;
  for (auto& [id, object] : objects->items()) {
    if (!object.is_object() || !object.contains("gated") || object.contains("unexplained"))
      continue;
    Json renamed = Json::object();
    for (auto& [key, value] : object.items()) {
      renamed[key == "gated" ? "unexplained" : key] = std::move(value);
    }
    object = std::move(renamed);
    any = true;
  }
  if (!any) return;
  folder.warnings.push_back(renamed_warning(path.string(), "key", "gated", "unexplained", "0.4"));
}

}  // namespace

void keep_files_of_run(ReportFolder& folder, const std::filesystem::path& path,
                       const std::string& metrics) {
  Json& numbers = folder.documents[metrics];
  if (!numbers.is_object()) return;
  for (const auto& [name, digest] : folder.digests) {
    if (belongs(name, digest, numbers)) continue;
    folder.documents.erase(name);
    folder.tables.erase(name);
    folder.warnings.push_back(
        fmt::format("{}: is left out, as it is not of the run whose {} is beside it",
                    (path / name).string(), metrics));
  }
  rename_gated(numbers, path / metrics, folder);
}

void require_one_run(const Json& trace, const Json& metrics, const std::filesystem::path& path) {
  // An earlier version wrote none.
  if (!metrics.is_object() || !metrics.contains("run")) return;
  if (trace.value("run", Json()) == metrics.at("run")) return;
  throw InvalidInput(
      fmt::format("{}: got trace.json and metrics.json of two runs, as where a run was cut off "
                  "while it put its files in place, expected both of one: run posemix slam again",
                  path.string()));
}

}  // namespace posemix::internal
