// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <algorithm>
#include <memory>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "recording.hpp"
#include "report.hpp"
#include "run.hpp"

namespace posemix {
namespace {

struct FiducialItem {
  FiducialRecording recording;
  std::variant<FiducialInput, FiducialPeer> estimator;
};

/// The word in the tables.
std::string estimator_name(const FiducialItem& item) {
  const auto* const peer = std::get_if<FiducialPeer>(&item.estimator);
  return peer != nullptr ? peer->name
                         : std::string(word_of(std::get<FiducialInput>(item.estimator)));
}

std::vector<FiducialRecording> selected_fiducial_recordings(
    const FiducialsStudySettings& settings) {
  const std::filesystem::path folder = settings.data / settings.folder;
  std::vector<FiducialRecording> recordings = find_fiducial_recordings(folder);
  if (settings.recordings.empty()) return recordings;
  for (const std::string& name : settings.recordings) {
    const auto is_it = [&](const FiducialRecording& recording) { return recording.name == name; };
    if (std::none_of(recordings.begin(), recordings.end(), is_it)) {
      std::vector<std::string> names;
      names.reserve(recordings.size());
      for (const FiducialRecording& recording : recordings) names.push_back(recording.name);
      throw InvalidInput(fmt::format("{}: has no recording {}, expected one of {}", folder.string(),
                                     name, fmt::join(names, ", ")));
    }
  }
  std::erase_if(recordings, [&](const FiducialRecording& recording) {
    const auto& names = settings.recordings;
    return std::find(names.begin(), names.end(), recording.name) == names.end();
  });
  return recordings;
}

/// Everything that determines the result, except for the contents of the recordings.
std::string fiducials_settings_text(const FiducialsStudySettings& settings,
                                    const std::vector<FiducialItem>& items) {
  nlohmann::ordered_json json = {{"data", settings.data.string()},
                                 {"folder", settings.folder.string()},
                                 {"priors", settings.priors},
                                 {"set", settings.overrides}};
  json["size_m"] = settings.size_m ? nlohmann::ordered_json(*settings.size_m) : nullptr;
  for (const FiducialItem& item : items)
    json["items"].push_back({item.recording.name, estimator_name(item)});
  for (const FiducialPeer& peer : settings.peers)
    json["peers"].push_back({peer.name, peer.command});
  return json.dump();
}

FiducialInput fiducial_input_of(const TomlTable& table, const std::string& name) {
  std::vector<std::string_view> known;
  for (const auto& [word, input] : words<FiducialInput>) {
    if (word == name) return input;
    known.push_back(word);
  }
  table.fail("inputs", fmt::format("has {}, expected some of {}", name, fmt::join(known, ", ")));
}

/// Peers by their names in the tables, which the inputs have too.
std::vector<FiducialPeer> read_peers(const TomlTable& table) {
  std::vector<FiducialPeer> peers;
  for (const std::string& name : table.keys()) {
    for (const auto& [word, input] : words<FiducialInput>)
      if (word == name) table.fail(name, "is the name of an input, expected another one");
    peers.push_back({name, table.get_string(name)});
  }
  return peers;
}

}  // namespace

FiducialsStudySettings read_fiducials_settings(const TomlTable& table) {
  FiducialsStudySettings settings;
  settings.folder = table.get_string_or("folder", settings.folder.string());
  settings.recordings = table.get_strings_or("recordings", {});
  if (table.has("inputs")) {
    settings.inputs.clear();
    for (const std::string& name : table.get_strings("inputs"))
      settings.inputs.push_back(fiducial_input_of(table, name));
    if (settings.inputs.empty()) table.fail("inputs", "is empty, expected at least one");
  }
  if (const auto peers = table.find_table("peers")) settings.peers = read_peers(*peers);
  settings.priors = table.get_bool_or("priors", settings.priors);
  if (table.has("size_m")) settings.size_m = table.get_double("size_m", kPositive);
  settings.overrides = table.get_strings_or("set", {});
  return settings;
}

Study make_fiducials_study(const FiducialsStudySettings& settings) {
  const auto items = std::make_shared<std::vector<FiducialItem>>();
  for (const FiducialRecording& recording : selected_fiducial_recordings(settings)) {
    for (const FiducialInput input : settings.inputs) items->push_back({recording, input});
    for (const FiducialPeer& peer : settings.peers) items->push_back({recording, peer});
  }
  Study study;
  study.name = "fiducials";
  study.settings = fiducials_settings_text(settings, *items);
  study.items = items->size();
  study.run_item = [settings, items](std::size_t index) {
    const FiducialItem& item = items->at(index);
    const auto run = [&](const auto& estimator) {
      return run_fiducials(item.recording, estimator, settings).dump();
    };
    return std::visit(run, item.estimator);
  };
  study.report = report_fiducials;
  return study;
}

}  // namespace posemix
