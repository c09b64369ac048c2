// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "posemix/detector/symmetry.hpp"

/// The file `models_info.json` of BOP: one entry per object id, with lengths in millimetres.
namespace posemix {

/// An axis-aligned box in the object's frame [m].
struct ObjectBox {
  Eigen::Vector3d lowest_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();

  std::array<Eigen::Vector3d, 8> corners() const;
};

/// The entry of one object in models_info.json, in metres.
struct BopModel {
  double diameter_m = 0.0;  ///< the largest distance of two vertices
  SymmetryGroup symmetries;
  std::optional<ObjectBox> box;  ///< from min_x .. size_z, if the entry has them
};

using BopModels = std::map<std::int64_t, BopModel>;

/// Reads the models of a text by object id.
///
/// Keys of an entry: diameter; min_x, min_y, min_z, size_x, size_y, size_z (all or none);
/// symmetries_discrete, each 16 numbers of a 4x4 matrix row by row; symmetries_continuous, each
/// {axis, offset}, where the axis goes through the point `offset`. The group is discrete times
/// continuous, as the BOP toolkit combines them. Other keys are ignored.
/// @throws InvalidInput `name: id: key: ...` for anything else, and for symmetries that are not a
/// group
BopModels parse_bop_models(std::string_view text, const std::string& name);

/// Reads one model of a text; errors in the others are ignored.
BopModel parse_bop_model(std::string_view text, const std::string& name, std::int64_t object);

/// Read a file as parse_bop_models and parse_bop_model read a text.
BopModels read_bop_models(const std::filesystem::path& path);
BopModel read_bop_model(const std::filesystem::path& path, std::int64_t object);

}  // namespace posemix
