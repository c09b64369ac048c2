// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/lie/lie.hpp"

/// BOP result files: CSV `scene_id,im_id,obj_id,score,R,t,time`, R row-major, t in millimetres.
namespace posemix {

/// One estimate of an object in one image.
struct ScoredPose {
  double score = 0;  ///< the estimator's confidence, larger is surer
  SE3d pose;         ///< T_camera_object, metres
};

/// The rows of a BOP file that are wanted.
struct BopSelection {
  std::int64_t scene = 0;
  std::int64_t object = 0;
};

/// Estimates by image id, those of one image in the file's order (there may be several instances of
/// one object).
using BopDetections = std::map<std::int64_t, std::vector<ScoredPose>>;

/// The estimates of one object in one scene; millimetres become metres, rotations the nearest
/// rotation.
///
/// The header line is optional. The form of every row is checked, the pose of the selected rows
/// only. Throws InvalidInput `name:line: got ..., expected ...`, and when no row is selected.
BopDetections parse_bop(std::string_view text, const std::string& name, BopSelection selection);

/// As parse_bop, for a file.
BopDetections read_bop(const std::filesystem::path& path, BopSelection selection);

/// One row of a BOP file.
struct BopRow {
  std::int64_t scene = 0;
  std::int64_t image = 0;
  std::int64_t object = 0;
  double score = 0;
  SE3d pose;  ///< T_camera_object, metres
};

/// All rows in the file's order, checked as by parse_bop; at least one.
std::vector<BopRow> parse_bop_rows(std::string_view text, const std::string& name);

/// As parse_bop_rows, for a file.
std::vector<BopRow> read_bop_rows(const std::filesystem::path& path);

}  // namespace posemix
