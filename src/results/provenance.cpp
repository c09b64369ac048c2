// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/provenance.hpp"

#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <set>

#include <fmt/format.h>

#include "io/sha256.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "provenance_json.hpp"

namespace posemix {
namespace {

using namespace internal;

namespace fs = std::filesystem;

/// A word that a shell takes as it is, or in single quotes.
std::string quoted_word(const std::string& word) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789@%+=:,./_-";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// The end of the year 9999, the last with four digits [s since 1970].
constexpr std::int64_t kLastSecond = 253402300799;

/// The seconds of SOURCE_DATE_EPOCH.
std::optional<std::time_t> epoch_of_environment() {
  const char* text = std::getenv("SOURCE_DATE_EPOCH");
  if (text == nullptr) return std::nullopt;
  const char* end = text + std::strlen(text);
  std::int64_t seconds = 0;
  const auto [read, error] = std::from_chars(text, end, seconds);
  if (error != std::errc() || read != end || seconds < 0 || seconds > kLastSecond)
    return std::nullopt;
  return static_cast<std::time_t>(seconds);
}

Json parsed(const std::string& text, const char* name) {
  try {
    Json json = Json::parse(text);
    if (json.is_object()) return json;
  } catch (const Json::exception&) {
    // Reported below.
  }
  throw InvalidInput(
      fmt::format("{}: got {}, expected an object as JSON", name, in_quotes(text, 80)));
}

}  // namespace

std::string quoted_command(std::span<const std::string> words) {
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    line += quoted_word(word);
  }
  return line;
}

std::string utc_now() {
  const std::time_t now = epoch_of_environment().value_or(
      std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()));
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", parts.tm_year + 1900, parts.tm_mon + 1,
                     parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec);
}

std::vector<ProvenanceInput> provenance_inputs(std::span<const fs::path> paths) {
  std::vector<ProvenanceInput> inputs;
  std::set<fs::path> known;
  for (const fs::path& path : paths) {
    if (!known.insert(path).second) continue;
    std::error_code error;
    const bool is_file = fs::is_regular_file(path, error);
    inputs.push_back({path, is_file ? sha256_of_file(path) : std::string()});
  }
  return inputs;
}

Json internal::provenance_json(const Provenance& provenance) {
  Json json = {{"program", "posemix"}, {"version", POSEMIX_VERSION}};
  json["instructions"] =
      provenance.instructions.empty() ? Json(nullptr) : Json(provenance.instructions);
  if (!provenance.command.empty()) json["command"] = quoted_command(provenance.command);
  if (provenance.seed) json["seed"] = *provenance.seed;
  if (!provenance.settings.empty()) json["settings"] = parsed(provenance.settings, "settings");
  if (!provenance.finished.empty()) json["finished"] = provenance.finished;
  Json inputs = Json::array();
  for (const ProvenanceInput& input : provenance.inputs) {
    inputs.push_back({{"path", input.path.string()},
                      {"sha256", input.sha256.empty() ? Json(nullptr) : Json(input.sha256)}});
  }
  json["inputs"] = std::move(inputs);
  return json;
}

std::string study_with_provenance(const std::string& study, const Provenance& provenance,
                                  std::span<const std::string> files) {
  Json document = parsed(study, "study.json");
  document["files"] = std::vector<std::string>(files.begin(), files.end());
  document["provenance"] = provenance_json(provenance);
  return json_text(document, 1);
}

}  // namespace posemix
