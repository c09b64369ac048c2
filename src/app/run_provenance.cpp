// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run_provenance.hpp"

#include <filesystem>
#include <variant>

#include <nlohmann/json.hpp>

namespace posemix {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

std::string settings_text(const OrderedJson& settings) {
  return settings.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

}  // namespace

std::vector<std::string> command_words(int argc, const char* const* argv) {
  std::vector<std::string> words(argv, argv + argc);
  if (!words.empty()) words.front() = fs::path(words.front()).filename().string();
  return words;
}

Provenance run_provenance(const std::vector<std::string>& command, const std::string& file,
                          const std::vector<std::string>& overrides, const TomlDocument& document,
                          const SlamJob& job) {
  OrderedJson values = OrderedJson::object();
  for (const std::string& key : document.root().keys()) values[key] = document.root().text_of(key);
  std::vector<fs::path> inputs{file};
  inputs.insert(inputs.end(), document.inputs().begin(), document.inputs().end());
  Provenance provenance{.command = command, .seed = {}};
  const auto* particles = std::get_if<ParticleFilterSettings>(&job.settings.tracker);
  if (particles != nullptr) provenance.seed = particles->seed;
  provenance.settings = settings_text({{"overrides", overrides}, {"values", values}});
  provenance.inputs = provenance_inputs(inputs);
  return provenance;
}

Provenance study_provenance(const std::vector<std::string>& command, const std::string& settings,
                            const std::string& file) {
  Provenance provenance{.command = command, .seed = {}};
  const auto parsed = nlohmann::json::parse(settings, nullptr, false);
  if (parsed.is_object() && parsed.contains("seed") && parsed["seed"].is_number_unsigned())
    provenance.seed = parsed["seed"].get<std::uint64_t>();
  if (parsed.is_object()) provenance.settings = settings;
  if (!file.empty()) provenance.inputs = provenance_inputs(std::vector{fs::path(file)});
  return provenance;
}

}  // namespace posemix
