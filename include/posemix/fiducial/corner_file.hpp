// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/fiducial/tag_pose.hpp"

namespace posemix {

/// The corners of one tag in one image.
struct CornerSighting {
  double stamp_s = 0.0;
  std::string topic = {};   ///< of the camera, or its name
  std::int64_t tag = 0;     ///< id
  std::string place = {};   ///< `file:line` for messages; empty where it is from no file
  TagCorners corners = {};  ///< in the order of the file [px]
};

/// The rows of a CSV table with the columns `stamp_s,topic,tag,u0_px,v0_px,...,u3_px,v3_px`, in
/// their order; other columns are left aside.
/// @throws InvalidInput `name:line: got ..., expected ...`, and when there are no rows
std::vector<CornerSighting> parse_corners(std::string_view text, const std::string& name);

/// Reads a file, which may be compressed by gzip, as parse_corners reads a text.
std::vector<CornerSighting> read_corners(const std::filesystem::path& path);

}  // namespace posemix
