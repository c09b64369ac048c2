// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/observation_sequence.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBareKey =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";

/// A string in the quotes of TOML.
std::string toml_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

std::string key_text(const std::string& key) {
  const bool bare = !key.empty() && key.find_first_not_of(kBareKey) == std::string::npos;
  return bare ? key : toml_string(key);
}

/// The keys of a table, one per line, but for some.
std::string lines_of(const TomlTable& table, std::initializer_list<std::string_view> without = {}) {
  std::string text;
  for (const std::string& key : table.keys()) {
    if (std::find(without.begin(), without.end(), key) != without.end()) continue;
    text += fmt::format("{} = {}\n", key_text(key), table.text_of(key));
  }
  return text;
}

std::string tables_of(const TomlTable& root, const std::string& key,
                      std::initializer_list<std::string_view> without = {}) {
  std::string text;
  for (const TomlTable& table : root.find_tables(key))
    text += fmt::format("\n[[{}]]\n{}", key, lines_of(table, without));
  return text;
}

/// The folders in which the files of the document lie.
std::vector<std::string> absolute_roots(const TomlTable& root,
                                        const std::vector<fs::path>& folders) {
  std::vector<std::string> roots{"."};
  for (const fs::path& folder : folders) {
    for (const std::string& name : root.get_strings_or("roots", {"."})) {
      std::string path = internal::absolute_path(folder / name).string();
      if (std::find(roots.begin(), roots.end(), path) == roots.end())
        roots.push_back(std::move(path));
    }
  }
  return roots;
}

Observation named(Observation observation, const std::string& object, double stamp) {
  observation.object = object;
  observation.stamp_s = stamp;
  return observation;
}

bool is_same(const std::optional<SE3d>& a, const std::optional<SE3d>& b) {
  if (a.has_value() != b.has_value()) return false;
  return !a || (a->translation() == b->translation() &&
                a->rotation().quaternion().coeffs() == b->rotation().quaternion().coeffs());
}

void require_same(const std::vector<std::optional<SE3d>>& a,
                  const std::vector<std::optional<SE3d>>& b, const std::string& what) {
  if (std::equal(a.begin(), a.end(), b.begin(), b.end(), is_same)) return;
  throw InvalidInput(
      fmt::format("{} differs: frames that are known by numbers need numbers without gaps", what));
}

}  // namespace

std::vector<Observation> observations_of(const Sequence& sequence) {
  validate(sequence);
  std::vector<Observation> all;
  for (std::size_t frame = 0; frame < sequence.stamps.size(); ++frame) {
    const double stamp = sequence.stamps[frame];
    if (!sequence.observations.empty()) {
      const auto& seen = sequence.observations[frame];
      all.insert(all.end(), seen.begin(), seen.end());
    } else {
      for (const ObjectRecording& object : sequence.objects) {
        if (const auto& pose = object.detections[frame])
          all.push_back(named(observation_of(*pose), object.id, stamp));
      }
    }
    if (sequence.candidates.empty()) continue;
    for (const Candidate& candidate : sequence.candidates[frame])
      all.push_back(named(observation_of(candidate), "", stamp));
  }
  return all;
}

std::string format_observation_sequence(const TomlDocument& document,
                                        const std::vector<fs::path>& folders,
                                        const ObservationSequenceFiles& files) {
  const TomlTable root = document.root();
  std::vector<std::string> roots;
  for (const std::string& path : absolute_roots(root, folders)) roots.push_back(toml_string(path));
  std::string values;
  std::string tables =
      fmt::format("\n[[observations]]\n{} = {}\n", files.key, toml_string(files.observations));
  std::string camera = fmt::format("\n[camera]\nstamps = {}\n", toml_string(files.stamps));
  for (const std::string& key : root.keys()) {
    if (key == "roots" || key == "candidates" || key == "observations") continue;
    if (key == "camera") {
      camera += lines_of(root.get_table(key), {"stamps"});
    } else if (key == "objects" || key == "cameras" || key == "frames") {
      tables += tables_of(root, key, {"detections"});
    } else if (root.is_table(key)) {
      tables += fmt::format("\n[{}]\n{}", key_text(key), lines_of(root.get_table(key)));
    } else if (key == "schema" || key == "sequence") {
      // Other values at the top are for strings, in which they have been put in.
      values += fmt::format("{} = {}\n", key, root.text_of(key));
    }
  }
  return fmt::format("{}roots = [{}]\n{}{}", values, fmt::join(roots, ", "), camera, tables);
}

void require_same_frames(const Sequence& a, const Sequence& b) {
  if (a.stamps != b.stamps) throw InvalidInput("the stamps of the frames differ");
  require_same(a.odometry, b.odometry, "the odometry");
  require_same(a.camera_truth, b.camera_truth, "the camera's ground truth");
  for (std::size_t i = 0; i < std::min(a.objects.size(), b.objects.size()); ++i) {
    const std::string name = fmt::format("the ground truth of object '{}'", a.objects[i].id);
    require_same(a.objects[i].relative_truth, b.objects[i].relative_truth, name);
    require_same(a.objects[i].world_truth, b.objects[i].world_truth, name);
  }
}

}  // namespace posemix
