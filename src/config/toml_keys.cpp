// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>
#include <numeric>

#include <fmt/format.h>

#include "toml_node.hpp"

namespace posemix::internal {
namespace {

struct Unit {
  std::string_view suffix, name, dimension;
};

constexpr std::array<Unit, 16> kUnits{{{"_rad_per_s", "radians per second", "angular speed"},
                                       {"_deg_per_s", "degrees per second", "angular speed"},
                                       {"_m_per_s", "metres per second", "speed"},
                                       {"_deg", "degrees", "angle"},
                                       {"_rad", "radians", "angle"},
                                       {"_mm", "millimetres", "length"},
                                       {"_cm", "centimetres", "length"},
                                       {"_m", "metres", "length"},
                                       {"_ms", "milliseconds", "time"},
                                       {"_us", "microseconds", "time"},
                                       {"_s", "seconds", "time"},
                                       {"_hz", "hertz", "frequency"},
                                       {"_frames", "frames", "time"},
                                       {"_percent", "percent", "share"},
                                       {"_kg", "kilograms", "mass"},
                                       {"_px", "pixels", "pixels"}}};

constexpr Unit kNoUnit{"", "no unit", ""};

const Unit& unit_of(std::string_view key) {
  const auto fits = [&](const Unit& unit) {
    return key.size() > unit.suffix.size() && key.ends_with(unit.suffix);
  };
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), fits);
  return found == kUnits.end() ? kNoUnit : *found;
}

std::string_view base_of(std::string_view key) {
  return key.substr(0, key.size() - unit_of(key).suffix.size());
}

/// The least number of insertions, deletions and replacements that turn a into b (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

[[noreturn]] void fail_unknown(const TomlState& state, const TomlNode& table, std::size_t index,
                               const std::string& path) {
  const std::string& key = table.keys[index];
  const TomlNode& node = table.children[index];
  const std::vector<std::string_view> known(table.known.begin(), table.known.end());
  const std::string full = join_toml_path(path, key);
  const std::string_view other_unit = same_name_other_unit(key, known);
  if (!other_unit.empty()) {
    state.fail(node, fmt::format("key '{}': expected {}", full, describe_with_unit(other_unit)));
  }
  const std::string_view near = nearest_name(key, known);
  if (!near.empty())
    state.fail(node, fmt::format("unknown key '{}', did you mean '{}'?", full, near));
  state.fail(node, fmt::format("unknown key '{}', known here: {}", full, fmt::join(known, ", ")));
}

}  // namespace

std::string_view same_name_other_unit(std::string_view key,
                                      const std::vector<std::string_view>& names) {
  std::string_view found;
  for (const std::string_view name : names) {
    if (name == key || base_of(name) != base_of(key)) continue;
    const bool same_dimension = unit_of(name).dimension == unit_of(key).dimension;
    if (found.empty() || same_dimension) found = name;
  }
  return found;
}

std::string describe_with_unit(std::string_view key) {
  return fmt::format("'{}' ({})", key, unit_of(key).name);
}

std::string_view nearest_name(std::string_view key, const std::vector<std::string_view>& names) {
  constexpr std::size_t kLongestName = 100;
  std::string_view nearest;
  if (key.empty() || key.size() > kLongestName) return nearest;
  std::size_t least = std::min<std::size_t>(2, (key.size() - 1) / 2) + 1;
  for (const std::string_view name : names) {
    if (name.size() > kLongestName) continue;
    const std::size_t distance = edit_distance(key, name);
    if (distance < least) {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

void require_all_known(const TomlState& state, const TomlNode& table, const std::string& path) {
  for (std::size_t i = 0; i < table.keys.size(); ++i) {
    if (!table.known.contains(table.keys[i])) fail_unknown(state, table, i, path);
  }
  for (std::size_t i = 0; i < table.keys.size(); ++i) {
    const TomlNode& child = table.children[i];
    const std::string child_path = join_toml_path(path, table.keys[i]);
    if (child.kind == TomlKind::table) require_all_known(state, child, child_path);
    if (child.kind != TomlKind::array) continue;
    for (std::size_t k = 0; k < child.children.size(); ++k) {
      const TomlNode& item = child.children[k];
      if (item.kind == TomlKind::table) {
        require_all_known(state, item, fmt::format("{}[{}]", child_path, k));
      }
    }
  }
}

}  // namespace posemix::internal
