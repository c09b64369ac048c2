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
  double score = 0;  ///< confidence of the estimator; larger is more certain
  SE3d pose;         ///< T_camera_object, metres
};

/// The object whose rows of a BOP file are read.
struct BopSelection {
  std::int64_t scene = 0;
  std::int64_t object = 0;
};

/// Estimates by image id; those of one image are in the order of the file (there may be several
/// instances of one object).
using BopDetections = std::map<std::int64_t, std::vector<ScoredPose>>;

/// Reads the estimates of one object in one scene. Lengths are converted to metres; a rotation is
/// the one nearest to the matrix in the file.
///
/// The header line is optional. The format of every row is checked, the pose only in the selected
/// rows.
/// @throws InvalidInput `name:line: got ..., expected ...`, and when no row is selected
BopDetections parse_bop(std::string_view text, const std::string& name, BopSelection selection);

/// Reads a file as parse_bop reads a text.
BopDetections read_bop(const std::filesystem::path& path, BopSelection selection);

/// One row of a BOP file.
struct BopRow {
  std::int64_t scene = 0;
  std::int64_t image = 0;
  std::int64_t object = 0;
  double score = 0;
  SE3d pose;  ///< T_camera_object, metres
};

/// All rows, at least one, in the order of the file, with the checks of parse_bop.
std::vector<BopRow> parse_bop_rows(std::string_view text, const std::string& name);

/// Reads a file as parse_bop_rows reads a text.
std::vector<BopRow> read_bop_rows(const std::filesystem::path& path);

}  // namespace posemix
