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

/// PLY meshes, as BOP's models are stored.
namespace posemix {

/// The positions of a mesh's vertices, in the file's order and unit times `unit_m` (BOP: 1e-3).
///
/// Formats ascii 1.0 and binary_little_endian 1.0; `vertex` is the first element, with numbers x, y
/// and z and no lists. Other properties and what follows the vertices are skipped. Throws
/// InvalidInput `name: got ..., expected ...`, also for numbers that are not finite.
std::vector<Eigen::Vector3d> parse_ply_vertices(std::string_view bytes, const std::string& name,
                                                double unit_m);

/// A triangle mesh.
struct PlyMesh {
  std::vector<Eigen::Vector3d> vertices;
  /// Indices of each triangle's corners among the vertices, in the order of the file.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// As parse_ply_vertices, with the faces: those of the element `face`, lists `vertex_indices` or
/// `vertex_index`. A face of more corners becomes a fan of triangles about its first corner.
/// Throws InvalidInput, also for a mesh without faces, a face of fewer than three corners, and a
/// corner that is no vertex.
PlyMesh parse_ply_mesh(std::string_view bytes, const std::string& name, double unit_m);

/// As parse_ply_mesh, for a file.
PlyMesh read_ply_mesh(const std::filesystem::path& path, double unit_m);

}  // namespace posemix
