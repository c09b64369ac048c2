// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "posemix/results/report.hpp"
#include "report.hpp"

namespace posemix {
namespace {

struct YcbvItem {
  Recording recording;
  YcbvMethod method;
};

bool selected(const std::vector<std::string>& wanted, const std::string& name) {
  return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
}

std::vector<Recording> select_recordings(const YcbvStudySettings& settings) {
  std::vector<Recording> recordings = find_recordings(settings.data);
  std::erase_if(recordings, [&](const Recording& recording) {
    return !selected(settings.sequences, recording.sequence) ||
           !selected(settings.objects, recording.object);
  });
  if (recordings.empty()) {
    const auto list = [](const std::vector<std::string>& wanted) {
      return wanted.empty() ? std::string("any") : fmt::format("{}", fmt::join(wanted, ", "));
    };
    throw InvalidInput(fmt::format("{}: has no recording of sequence {} and object {}",
                                   settings.data.string(), list(settings.sequences),
                                   list(settings.objects)));
  }
  return recordings;
}

std::vector<YcbvItem> make_items(const YcbvStudySettings& settings,
                                 const std::vector<Recording>& recordings) {
  std::vector<YcbvItem> items;
  const auto names = settings.methods.empty() ? ycbv_methods() : settings.methods;
  std::vector<YcbvMethod> methods(names.size());
  std::transform(names.begin(), names.end(), methods.begin(), find_ycbv_method);
  for (const Recording& recording : recordings) {
    for (const YcbvMethod& method : methods) {
      if (method.fits(recording)) items.push_back({recording, method});
    }
  }
  if (items.empty())
    throw InvalidInput("methods: none of them is for the recordings that were selected");
  return items;
}

/// Everything that determines the result, except for the contents of the recordings.
std::string settings_text(const YcbvStudySettings& settings, const std::vector<YcbvItem>& items) {
  nlohmann::ordered_json json;
  json["data"] = settings.data.string();
  json["set"] = settings.overrides;
  for (const char* detector : {"cosypose", "dope"}) {
    const auto own = settings.profiles.find(detector);
    json["profiles"][detector] =
        own == settings.profiles.end() ? std::string(recording_profile(detector)) : own->second;
  }
  json["profiles"]["published"] = std::string(recording_profile("published"));
  if (settings.runs_in) json["reports"] = true;
  json["items"] = nlohmann::ordered_json::array();
  for (const auto& [recording, method] : items) {
    json["items"].push_back({{"detector", recording.detector},
                             {"object", recording.object},
                             {"sequence", recording.sequence},
                             {"objects", recording.objects},
                             {"method", method.name},
                             {"set", method.overrides}});
  }
  return json.dump();
}

}  // namespace

YcbvStudySettings read_ycbv_settings(const TomlTable& table, const std::filesystem::path& out) {
  YcbvStudySettings settings;
  if (table.get_bool_or("reports", false)) {
    require_report_page();
    settings.runs_in = out;
  }
  settings.methods = table.get_strings_or("methods", ycbv_methods());
  for (const std::string& method : settings.methods) {
    try {
      find_ycbv_method(method);
    } catch (const InvalidInput& error) {
      table.fail("methods", std::string("has ") + error.what());
    }
  }
  settings.sequences = table.get_strings_or("sequences", {});
  settings.objects = table.get_strings_or("objects", {});
  settings.overrides = table.get_strings_or("set", {});
  if (const auto profiles = table.find_table("profiles")) {
    for (const char* detector : {"cosypose", "dope"}) {
      if (profiles->has(detector))
        settings.profiles[detector] = read_file(profiles->get_string(detector));
    }
  }
  return settings;
}

Study make_ycbv_study(const YcbvStudySettings& settings) {
  auto items = std::make_shared<const std::vector<YcbvItem>>(
      make_items(settings, select_recordings(settings)));
  Study study;
  study.name = "ycbv";
  study.settings = settings_text(settings, *items);
  study.items = items->size();
  study.run_item = [settings, items](std::size_t index) {
    const auto& [recording, method] = items->at(index);
    return format_ycbv_rows(run_ycbv(settings, recording, method));
  };
  study.report = [](std::span<const std::string> results) { return report_ycbv(results); };
  return study;
}

}  // namespace posemix
