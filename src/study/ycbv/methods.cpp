// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "method.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "published.hpp"

namespace posemix {
namespace {

/// A method of the library in place of that of the profile.
std::vector<std::string> method_override(std::string_view name) {
  return {fmt::format("filter={{method='{}'}}", find_slam_method(name).name)};
}

std::vector<YcbvMethod> known_methods() {
  const auto own = [](const char* name) {
    return YcbvMethod{.name = name, .overrides = method_override(name)};
  };
  const auto paper = [&own](const char* name) {
    YcbvMethod method = own(name);
    method.paper_noise = true;
    return method;
  };
  return {{.name = "detector", .kind = YcbvKind::detector, .overrides = {}},
          {.name = "odometry", .kind = YcbvKind::odometry, .overrides = {}},
          {.name = "published_offline", .kind = YcbvKind::published_offline, .overrides = {}},
          paper("riekf"),
          paper("riekf_gated"),
          paper("riekf_cauchy"),
          own("max_mixture"),
          own("rbpf"),
          paper("tangent_of_larger"),
          paper("midway"),
          paper("midway_iterated"),
          {.name = "published", .published = true, .overrides = {}},
          {.name = "default", .overrides = {}},
          {.name = "default_smoothed", .overrides = {"filter.smooth=full"}}};
}

/// Odometry that the profile does not name, for the row of odometry alone.
void add_odometry(const Recording& recording, TomlDocument& document) {
  const auto camera = document.root().find_table("camera");
  const auto experiments = find_experiments(recording.data);
  if ((camera && camera->has("odometry")) || !experiments) return;
  const std::filesystem::path file =
      std::filesystem::absolute(*experiments) / "odom" / "results" / (recording.sequence + ".txt");
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return;
  document.apply_override(fmt::format("camera.odometry={}", file.string()));
}

}  // namespace

bool YcbvMethod::fits(const Recording& recording) const {
  if (kind == YcbvKind::published_offline) return !published_pixels(recording).empty();
  return !published || recording.detector == "cosypose";
}

std::vector<std::string> ycbv_methods() {
  std::vector<std::string> names;
  for (const YcbvMethod& method : known_methods()) names.push_back(method.name);
  return names;
}

YcbvMethod find_ycbv_method(const std::string& name) {
  const std::vector<YcbvMethod> known = known_methods();
  const auto found = std::find_if(known.begin(), known.end(),
                                  [&](const YcbvMethod& method) { return method.name == name; });
  if (found != known.end()) return *found;
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos || colon == 0) {
    throw InvalidInput(fmt::format(
        "method {}, expected one of {}, or \"NAME: KEY=VALUE ...\" for the default with overrides",
        in_quotes(name), fmt::join(ycbv_methods(), ", ")));
  }
  YcbvMethod method{.name = std::string(trimmed(name.substr(0, colon))), .overrides = {}};
  for (const std::string_view word : split_words(std::string_view(name).substr(colon + 1)))
    method.overrides.emplace_back(word);
  return method;
}

SlamJob read_ycbv_job(const YcbvStudySettings& settings, const Recording& recording,
                      const YcbvMethod& method) {
  const auto own = settings.profiles.find(std::string(profile_name_of(recording)));
  const bool replaced = own != settings.profiles.end() && !method.published;
  const std::string_view profile =
      replaced ? std::string_view(own->second)
               : recording_profile(method.published ? "published" : profile_name_of(recording));
  TomlDocument document = recording_document(recording, profile);
  if (method.kind == YcbvKind::odometry) add_odometry(recording, document);
  if (method.paper_noise && !replaced) {
    for (std::size_t i = 0; i < recording.objects.size(); ++i)
      document.apply_override(fmt::format("objects.{}.noise=gaussian", i));
  }
  for (const std::string& each : method.overrides) document.apply_override(each);
  for (const std::string& each : settings.overrides) document.apply_override(each);
  return read_slam_job(document, {recording.data});
}

}  // namespace posemix
