// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

/// PLY meshes, the format of BOP's models.
namespace posemix {

/// Reads the positions of a mesh's vertices, in the order of the file and in its unit times
/// `unit_m` (BOP: 1e-3).
///
/// Formats ascii 1.0 and binary_little_endian 1.0; `vertex` is the first element, with numbers x, y
/// and z and no lists. Other properties and the elements after the vertices are skipped.
/// @throws InvalidInput `name: got ..., expected ...`, also for numbers that are not finite
std::vector<Eigen::Vector3d> parse_ply_vertices(std::string_view bytes, const std::string& name,
                                                double unit_m);

/// A triangle mesh.
struct PlyMesh {
  std::vector<Eigen::Vector3d> vertices;
  /// Indices of the corners of each triangle among the vertices, in the order of the file.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Reads vertices as parse_ply_vertices, and the faces from the lists `vertex_indices` or
/// `vertex_index` of the element `face`. A face of more than three corners becomes a fan of
/// triangles about its first corner.
/// @throws InvalidInput as parse_ply_vertices, and for a mesh without faces, a face of fewer than
/// three corners, and a corner that is not a vertex
PlyMesh parse_ply_mesh(std::string_view bytes, const std::string& name, double unit_m);

/// Reads a file as parse_ply_mesh reads bytes.
PlyMesh read_ply_mesh(const std::filesystem::path& path, double unit_m);

}  // namespace posemix
