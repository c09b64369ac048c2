// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/ply.hpp"
#include "target.hpp"

/// Meshes: corners are vertices, and vertices are finite.
namespace posemix::fuzzing {

POSEMIX_FUZZ_TARGET(ply) {
  takes("m.ply", [&] {
    const PlyMesh mesh = parse_ply_mesh(bytes, "m.ply", 1e-3);
    for (const Eigen::Vector3d& vertex : mesh.vertices)
      expect(vertex.allFinite(), "a vertex that is not finite");
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle)
        expect(corner < mesh.vertices.size(), "a corner that is no vertex");
  });
  takes("m.ply", [&] {
    for (const Eigen::Vector3d& vertex : parse_ply_vertices(bytes, "m.ply", 1.0))
      expect(vertex.allFinite(), "a vertex that is not finite");
  });
}

}  // namespace posemix::fuzzing
