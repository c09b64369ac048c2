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

/// BOP's `models_info.json`: one entry per object id, lengths in millimetres.
namespace posemix {

/// An axis-aligned box in the object's frame [m].
struct ObjectBox {
  Eigen::Vector3d lowest_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();

  std::array<Eigen::Vector3d, 8> corners() const;
};

/// What models_info.json says of one object, in metres.
struct BopModel {
  double diameter_m = 0.0;  ///< the largest distance of two vertices
  SymmetryGroup symmetries;
  std::optional<ObjectBox> box;  ///< from min_x .. size_z, where the entry has them
};

using BopModels = std::map<std::int64_t, BopModel>;

/// The models of a text by object id.
///
/// Keys of an entry: diameter; min_x, min_y, min_z, size_x, size_y, size_z (all or none);
/// symmetries_discrete, each 16 numbers of a 4x4 matrix row by row; symmetries_continuous, each
/// {axis, offset}, the axis through the point `offset`. The group is discrete times continuous, as
/// the BOP toolkit combines them. Other keys are ignored. Throws InvalidInput `name: id: key: ...`
/// for anything else, and for symmetries that are no group.
BopModels parse_bop_models(std::string_view text, const std::string& name);

/// One model of a text; what is wrong with the others does not matter.
BopModel parse_bop_model(std::string_view text, const std::string& name, std::int64_t object);

/// As parse_bop_models and parse_bop_model, for a file.
BopModels read_bop_models(const std::filesystem::path& path);
BopModel read_bop_model(const std::filesystem::path& path, std::int64_t object);

}  // namespace posemix
