// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "io/file_moves.hpp"
#include "io/input_files.hpp"
#include "io/json_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "posemix/results/results.hpp"
#include "results/result_names.hpp"

namespace posemix {
namespace {

using namespace internal;

namespace fs = std::filesystem;

constexpr const char* kReportName = "report.html";
constexpr std::array kRunNames{"camera.tum",  "metrics.json", "posterior.json", "trace.json",
                               "picture.svg", "cameras.csv",  kReportName};
constexpr std::array kConsistencyNames{"consistency.json", "consistency.csv", "consistency.svg",
                                       "consistency.md", kReportName};

/// The names of an object's files, with {} for its own.
constexpr std::array kObjectNames{"object_{}.tum", "relative_{}.tum", "mixture_{}.json"};

/// The object of JSON that says which files are of a result, or of one that was about to be
/// replaced; empty where the file is missing, damaged or something else.
Json object_in(fs::path path) {
  std::error_code error;
  if (!fs::exists(path, error)) path = set_aside(path);
  if (!fs::is_regular_file(path, error)) return Json::object();
  try {
    Json json = Json::parse(internal::read_earlier_file(path), nullptr, false);
    return json.is_object() ? json : Json::object();
  } catch (const InvalidInput&) {
    return Json::object();
  }
}

/// The names that are there, each once, and are names of files within the folder.
std::vector<fs::path> there(const fs::path& folder, const std::set<std::string>& names) {
  std::vector<fs::path> found;
  for (const std::string& name : names) {
    const fs::path path(name);
    const bool is_name = path == path.filename() && !name.empty() && name != "." && name != "..";
    std::error_code error;
    if (is_name && fs::is_regular_file(folder / path, error)) found.push_back(path);
  }
  return found;
}

}  // namespace

bool internal::is_run_name(std::string_view name) {
  const auto fits = [&](std::string_view pattern) {
    const std::size_t id = pattern.find("{}");
    return name.starts_with(pattern.substr(0, id)) && name.ends_with(pattern.substr(id + 2));
  };
  return std::find(kRunNames.begin(), kRunNames.end(), name) != kRunNames.end() ||
         std::any_of(kObjectNames.begin(), kObjectNames.end(), fits);
}

bool internal::is_report_name(std::string_view name) { return name == kReportName; }

bool internal::is_consistency_name(std::string_view name) {
  return !is_report_name(name) && std::find(kConsistencyNames.begin(), kConsistencyNames.end(),
                                            name) != kConsistencyNames.end();
}

std::vector<fs::path> earlier_results(const fs::path& folder) {
  const Json metrics = object_in(folder / "metrics.json");
  const auto objects = metrics.find("objects");
  if (objects == metrics.end() || !objects->is_object()) return {};
  std::set<std::string> names(kRunNames.begin(), kRunNames.end());
  for (const auto& [id, numbers] : objects->items()) {
    for (const char* pattern : kObjectNames) names.insert(fmt::format(fmt::runtime(pattern), id));
  }
  return there(folder, names);
}

std::vector<fs::path> earlier_study(const fs::path& folder) {
  const Json study = object_in(folder / "study.json");
  const auto files = study.find("files");
  if (!study.contains("study")) return {};
  std::set<std::string> names{"study.json", kReportName};
  if (files != study.end() && files->is_array()) {
    for (const Json& name : *files)
      if (name.is_string()) names.insert(name.get<std::string>());
  }
  return there(folder, names);
}

std::vector<fs::path> earlier_consistency(const fs::path& folder) {
  const Json consistency = object_in(folder / "consistency.json");
  if (consistency.value("type", Json()) != "posemix.consistency") return {};
  return there(folder, {kConsistencyNames.begin(), kConsistencyNames.end()});
}

}  // namespace posemix
