// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/fiducial/tag_file.hpp"

/// The YAML files in a build without yaml-cpp: every function throws.
namespace posemix {
namespace {

[[noreturn]] void refuse(const std::string& name) {
  throw InvalidInput(
      fmt::format("{}: got a YAML file, expected none: this build of posemix is without yaml-cpp "
                  "(Debian: libyaml-cpp-dev), which is looked for when it is configured",
                  name));
}

}  // namespace

std::vector<RigCamera> parse_cameras(std::string_view, const std::string& name) { refuse(name); }
std::vector<RigCamera> read_cameras(const std::filesystem::path& path) { refuse(path.string()); }
void parse_camera_poses(std::string_view, const std::string& name, std::vector<RigCamera>&) {
  refuse(name);
}
void read_camera_poses(const std::filesystem::path& path, std::vector<RigCamera>&) {
  refuse(path.string());
}
TagMap parse_tag_map(std::string_view, const std::string& name) { refuse(name); }
TagMap read_tag_map(const std::filesystem::path& path) { refuse(path.string()); }

}  // namespace posemix
