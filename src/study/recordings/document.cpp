// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <regex>
#include <system_error>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/object_poses.hpp"
#include "posemix/io/text.hpp"
#include "recordings.hpp"
#include "table_folder.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

/// A header such as [camera] with the lines below it; no header at the top.
struct Section {
  std::string header = {};
  std::vector<std::string> lines = {};

  bool is_below(std::string_view table) const {
    return header == fmt::format("[{}]", table) || header.starts_with(fmt::format("[{}.", table));
  }
  bool is_object() const { return header == "[[objects]]"; }
};

std::vector<Section> sections_of(std::string_view profile) {
  static const std::regex header(R"((\[\[?[A-Za-z0-9_."-]+\]\]?)\s*(#.*)?)");
  const std::string text(profile);
  LineReader reader(text, "profile");
  std::vector<Section> sections(1);
  while (reader.next()) {
    const std::string line(reader.line());
    std::smatch match;
    // The tables of an object stay with it.
    if (std::regex_match(line, match, header) && !match[1].str().starts_with("[objects.")) {
      sections.push_back({match[1]});
    } else {
      sections.back().lines.push_back(line);
    }
  }
  return sections;
}

std::string_view key_of(std::string_view line) {
  const std::size_t end = line.find('=');
  return end == std::string_view::npos ? std::string_view() : trimmed(line.substr(0, end));
}

/// The first text in double quotes of a line.
std::string quoted_in(const std::string& line) {
  const std::size_t first = line.find('"');
  const std::size_t last = first == std::string::npos ? first : line.find('"', first + 1);
  return last == std::string::npos ? std::string() : line.substr(first + 1, last - first - 1);
}

void replace_all(std::string& text, std::string_view old, std::string_view by) {
  for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at))
    text.replace(at, old.size(), by);
}

/// Writes the sequence file of a recording.
class Writer {
 public:
  Writer(const Recording& recording, std::string_view profile)
      : recording_(recording), sections_(sections_of(profile)) {}

  std::string text() {
    find_files_of_camera();
    std::string text;
    bool objects_done = false;
    for (const Section& section : sections_) {
      if (!odometry_ && section.is_below("motion")) continue;
      if (!section.is_object()) {
        text += section.header + "\n" + lines_of(section, recording_.object);
      } else if (!objects_done) {
        for (const std::string& id : recording_.objects) text += object_text(id);
        objects_done = true;
      }
    }
    return text;
  }

  bool camera_truth() const { return camera_truth_; }

 private:
  /// Checks which files of the camera exist. A profile without odometry has a motion model that
  /// needs none.
  void find_files_of_camera() {
    for (const Section& section : sections_) {
      if (section.header != "[camera]") continue;
      for (const std::string& line : section.lines) {
        if (key_of(line) == "odometry") odometry_ = find(line).has_value();
        if (key_of(line) == "ground_truth") camera_truth_ = find(line).has_value();
      }
    }
  }

  /// The file that a line names, if it exists.
  std::optional<fs::path> find(const std::string& line) const {
    std::string name = quoted_in(line);
    replace_all(name, "${sequence}", recording_.sequence);
    replace_all(name, "${object}", recording_.object);
    for (const char* root : {".", "slam-super-6d"}) {
      fs::path place = recording_.data / root / name;
      std::error_code ignored;
      if (fs::exists(place, ignored)) return place;
    }
    return std::nullopt;
  }

  bool keeps(const std::string& line, const std::string& id) const {
    const std::string_view key = key_of(line);
    if (key == "object") return recording_.object != "all";  // several objects have no common key
    if (key == "odometry") return find(line).has_value();
    if (key != "ground_truth") return true;
    const auto place = find(line);
    if (!place || line.find("world_poses") == std::string::npos) return place.has_value();
    return read_object_poses(*place).contains(id);
  }

  std::string lines_of(const Section& section, const std::string& id) const {
    std::string text;
    for (const std::string& line : section.lines) {
      if (keeps(line, id)) text += line + "\n";
    }
    return text;
  }

  const Section& section_of(const std::string& id) const {
    const Section* chosen = nullptr;
    for (const Section& section : sections_) {
      if (!section.is_object()) continue;
      const bool same = std::any_of(
          section.lines.begin(), section.lines.end(),
          [&](const std::string& line) { return key_of(line) == "id" && quoted_in(line) == id; });
      if (same) return section;
      if (chosen == nullptr) chosen = &section;
    }
    if (chosen == nullptr) throw InvalidInput("profile: has no table [[objects]], expected one");
    return *chosen;
  }

  std::string object_text(const std::string& id) const {
    const Section& section = section_of(id);
    if (recording_.detector == "dope") return section.header + "\n" + lines_of(section, id);
    const std::string files = files_of(id);
    Section own{section.header};
    for (const std::string& line : section.lines) {
      const std::string_view key = key_of(line);
      if (key.empty() || files.find(fmt::format("{} = ", key)) == std::string::npos)
        own.lines.push_back(line);
    }
    return own.header + "\n" + files + lines_of(own, id);
  }

  /// The keys of an object that differ from recording to recording.
  std::string files_of(const std::string& id) const {
    if (recording_.detector == "cosypose") {
      return fmt::format(
          "id = \"{}\"\ndetections = {{npy = \"midway/cosypose/${{sequence}}\", prefix = "
          "\"obj_{:0>6}_\"}}\n",
          id, id);
    }
    const std::string table =
        fmt::format("{{pose_csv = \"{}/ycbv_{}.csv\", scene = {}, object = {}}}", kTableFolder,
                    recording_.detector, parse_integer(recording_.sequence).value_or(0), id);
    return fmt::format("id = \"{}\"\ndetections = {}\nground_truth = {}\n", id, table, table);
  }

  const Recording& recording_;
  std::vector<Section> sections_;
  bool odometry_ = true;
  bool camera_truth_ = false;
};

}  // namespace

TomlDocument recording_document(const Recording& recording, std::string_view profile) {
  Writer writer(recording, profile);
  const std::string text = writer.text();
  TomlDocument document = TomlDocument::parse(
      text, fmt::format("{} {} {}", recording.detector, recording.object, recording.sequence));
  document.apply_override(fmt::format("sequence=\"{}\"", recording.sequence));
  if (recording.object != "all")
    document.apply_override(fmt::format("object=\"{}\"", recording.object));
  if (!writer.camera_truth()) document.apply_override("camera.start.pose=\"identity\"");
  return document;
}

}  // namespace posemix
