// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "columns.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using Pair = std::pair<std::string_view, std::string_view>;

/// Ends of names, and the units that they stand for.
constexpr std::array<Pair, 13> kUnitsOfEnds{{{"_per_rad3", "rad^-3"},
                                             {"_deg", "deg"},
                                             {"_rad", "rad"},
                                             {"_mm", "mm"},
                                             {"_cm", "cm"},
                                             {"_m", "m"},
                                             {"_ms", "ms"},
                                             {"_us", "us"},
                                             {"_s", "s"},
                                             {"_nats", "nats"},
                                             {"_m3", "m^3"},
                                             {"_frames", "frames"},
                                             {"_px", "px"}}};

/// Whole names, and their units.
constexpr std::array<Pair, 11> kUnitsOfNames{{{"kl", "nats"},
                                              {"isd", "rad^-3"},
                                              {"pixel_median", "px"},
                                              {"pixel_median_last_map", "px"},
                                              {"log_loss", "nats"},
                                              {"log_density", "nats"},
                                              {"log_evidence", "nats"},
                                              {"median_ms_per_run", "ms"},
                                              {"median_us_per_detection", "us"},
                                              {"noise_exponent", "power of ten"},
                                              {"frames", "frames"}}};

/// Ends that say what a number is of another one.
constexpr std::array<Pair, 5> kRoles{{{"_standard_error", ", standard error"},
                                      {"_error", ", standard error"},
                                      {"_sd", ", standard deviation"},
                                      {"_band_low", ", 95 % band from"},
                                      {"_band_high", ", 95 % band to"}}};

constexpr std::array<Pair, 23> kWords{{{"anees", "ANEES"},
                                       {"nees", "NEES"},
                                       {"rmse", "error (rms)"},
                                       {"rms", "error (rms)"},
                                       {"kl", "KL divergence"},
                                       {"isd", "integral square distance"},
                                       {"auc", "AUC"},
                                       {"bic", "BIC"},
                                       {"mssd", "MSSD"},
                                       {"act", "ACT"},
                                       {"phi", "angle phi"},
                                       {"rel", "relative"},
                                       {"sd", "standard deviation"},
                                       {"std", "standard deviation"},
                                       {"log", "logarithm of"},
                                       {"dof", "degree of freedom"},
                                       {"brier", "Brier score"},
                                       {"lag1", "lag-1"},
                                       {"im", "image"},
                                       {"symm", "symmetric"},
                                       {"end", "at the end:"},
                                       {"paired", "over the views with both:"},
                                       {"within", "within the limits,"}}};

/// Names that are not the words that they consist of.
constexpr std::array<Pair, 12> kTitles{
    {{"log_loss", "logarithmic loss"},
     {"log_likelihood", "log-likelihood"},
     {"nees_per_dof", "NEES per degree of freedom"},
     {"rotation_nees_per_dof", "NEES of the rotation per degree of freedom"},
     {"calibration_error", "calibration error"},
     {"right_mode", "share on the right mode"},
     {"right_mode_error", "share on the right mode, standard error"},
     {"recycled", "tracks that were given to another instance"},
     {"flip_share", "share of steps at which the orientation flips"},
     {"axis_turn_share", "share of steps at which an axis turns over"},
     {"first_detection_wrong", "first detection is wrong"},
     {"standard_error", "standard error"}}};

/// The value of a key, or another text.
template <std::size_t size>
std::string_view found_or(const std::array<Pair, size>& table, std::string_view key,
                          std::string_view otherwise) {
  const auto* const found =
      std::find_if(table.begin(), table.end(), [&](const Pair& pair) { return pair.first == key; });
  return found == table.end() ? otherwise : found->second;
}

/// Takes the end of a name that a table lists away, and returns what the table says of it.
template <std::size_t size>
std::string_view take_end(const std::array<Pair, size>& table, std::string_view& name) {
  for (const auto& [end, text] : table) {
    if (!name.ends_with(end) || name.size() == end.size()) continue;
    name.remove_suffix(end.size());
    return text;
  }
  return {};
}

std::string words_of_name(std::string_view name) {
  std::string title;
  for (const std::string_view word : split_fields(name, '_'))
    title += (title.empty() ? "" : " ") + std::string(found_or(kWords, word, word));
  return title;
}

bool has_column(std::span<const std::string> columns, std::string_view name) {
  return std::find(columns.begin(), columns.end(), name) != columns.end();
}

}  // namespace

ColumnText column_text(std::string_view name) {
  const std::string_view title = found_or(kTitles, name, "");
  if (!title.empty()) return {std::string(title), {}};
  std::string_view rest = name;
  std::string_view role = take_end(kRoles, rest);
  std::string_view unit = found_or(kUnitsOfNames, rest, "");
  if (unit.empty()) unit = take_end(kUnitsOfEnds, rest);
  if (role.empty() && rest.ends_with(kRoles.front().first)) role = take_end(kRoles, rest);
  return {words_of_name(rest) + std::string(role), std::string(unit)};
}

std::string standard_error_column(std::string_view name, std::span<const std::string> columns) {
  std::string_view base = name;
  const std::string_view unit = take_end(kUnitsOfEnds, base);
  const std::string end = unit.empty() ? "" : std::string(name.substr(base.size()));
  for (const std::string& candidate :
       {std::string(name) + "_standard_error", std::string(name) + "_error",
        std::string(base) + "_standard_error" + end}) {
    if (candidate != name && has_column(columns, candidate)) return candidate;
  }
  return {};
}

nlohmann::ordered_json columns_json(std::span<const std::string> columns) {
  const bool has_units = has_column(columns, "unit");
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const std::string& name : columns) {
    const ColumnText text = column_text(name);
    nlohmann::ordered_json& entry = json[name];
    entry = {{"title", text.title}, {"unit", text.unit}};
    const std::string error = standard_error_column(name, columns);
    if (!error.empty()) entry["standard_error"] = error;
    constexpr std::array<std::string_view, 9> kByUnit{
        "mean",    "sd",   "rms", "median", "robust_sd", "inlier_sd", "inlier_sd_of_recordings",
        "bias_sd", "value"};
    if (has_units && std::find(kByUnit.begin(), kByUnit.end(), name) != kByUnit.end())
      entry["unit_column"] = "unit";
  }
  return json;
}

}  // namespace posemix
