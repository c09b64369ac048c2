// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/run_program.hpp"

namespace posemix::testing {

/// A run of a program whose calls that change files below a folder were counted, and disturbed.
struct FaultyRun {
  ProgramResult result;
  std::vector<std::string> calls;  ///< in their order
};

/// `fault` is as inject.cpp has it; empty for an undisturbed run. A command may begin with another
/// program that starts posemix.
inline FaultyRun run_with_fault(const std::vector<std::string>& command, const std::string& fault,
                                const std::filesystem::path& below) {
  const TemporaryFolder folder;
  const std::string log = (folder / "log").string();
  std::vector<std::string> words{"/usr/bin/env",
                                 "LD_PRELOAD=" POSEMIX_FAULTS,
                                 "ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0",
                                 "SOURCE_DATE_EPOCH=0",
                                 "POSEMIX_FAULT_BELOW=" + below.string(),
                                 "POSEMIX_FAULT_LOG=" + log};
  if (!fault.empty()) words.push_back("POSEMIX_FAULT=" + fault);
  words.insert(words.end(), command.begin(), command.end());
  FaultyRun run{RunningProgram(words).wait(), {}};
  std::ifstream lines(log);
  for (std::string number, call; lines >> number >> call;) run.calls.push_back(call);
  return run;
}

/// Text files by name, without what differs from run to run: times, and the folder's own name.
using Contents = std::map<std::string, std::string>;

inline std::string comparable(const std::filesystem::path& path,
                              const std::filesystem::path& folder) {
  std::string text = content_of(path);
  for (std::size_t at = 0; (at = text.find(folder.string(), at)) != std::string::npos;)
    text.replace(at, folder.string().size(), "FOLDER");
  if (path.extension() != ".json") return text;
  auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return text;
  json.erase("timing");
  if (json.contains("provenance")) json["provenance"].erase("command");
  // The times at which files came from a server.
  if (json.contains("files") && json["files"].is_object())
    for (auto& [name, file] : json["files"].items())
      if (file.is_object()) file.erase("date");
  return json.dump();
}

/// Part of what a command writes: a folder that is a result by the file `key`, or a file.
struct Part {
  std::string name;
  std::string key;  ///< empty for a file
};

/// What is there of a part: nothing, unless it can be taken for a result.
inline std::optional<Contents> result_in(const std::filesystem::path& folder, const Part& part) {
  const std::filesystem::path path = folder / part.name;
  Contents contents;
  if (part.key.empty()) {
    if (!std::filesystem::exists(path)) return std::nullopt;
    contents[part.name] = comparable(path, folder);
    return contents;
  }
  if (!std::filesystem::exists(path / part.key)) return std::nullopt;
  for (const std::string& name : names_in(path)) {
    // Hidden files are part of no result, and times of none that is compared.
    if (!name.starts_with('.') && !name.starts_with("timing"))
      contents[name] = comparable(path / name, folder);
  }
  return contents;
}

/// Whether every point is to be visited (make faults), and not only some.
inline bool visits_all() {
  const char* const all = std::getenv("POSEMIX_FAULT_POINTS");
  return all != nullptr && std::string_view(all) == "all";
}

/// The numbers of the calls to disturb: all, or the first and last of every kind.
inline std::vector<std::size_t> points(const std::vector<std::string>& calls) {
  std::vector<std::size_t> numbers;
  std::map<std::string, std::pair<std::size_t, std::size_t>> ends;
  for (std::size_t i = 0; i < calls.size(); ++i) {
    ends.try_emplace(calls[i], i, i).first->second.second = i;
  }
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const auto& [first, last] = ends.at(calls[i]);
    if (visits_all() || i == first || i == last) numbers.push_back(i + 1);
  }
  return numbers;
}

}  // namespace posemix::testing
