// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/ply.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "expect_invalid.hpp"

namespace posemix {
namespace {

const std::string kAscii =
    "ply\nformat ascii 1.0\ncomment any\nelement vertex 2\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\n"
    "end_header\n1 2 3 255\n-4.5 0 6e1 0\n3 0 1 0\n";

std::vector<Eigen::Vector3d> parse_vertices(const std::string& bytes) {
  return parse_ply_vertices(bytes, "m.ply", 1e-3);
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

template <typename Number>
void append(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

TEST(Ply, Ascii) {
  const auto vertices = parse_vertices(kAscii);
  ASSERT_EQ(vertices.size(), 2U);
  EXPECT_LT((vertices[0] - Eigen::Vector3d(0.001, 0.002, 0.003)).norm(), 1e-15);
  EXPECT_LT((vertices[1] - Eigen::Vector3d(-0.0045, 0, 0.06)).norm(), 1e-15);
}

TEST(Ply, BinaryWithPropertiesInAnyOrder) {
  std::string bytes =
      "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 2\r\nproperty uchar red\r\n"
      "property double z\r\nproperty float x\r\nproperty short any\r\nproperty float y\r\n"
      "end_header\r\n";
  for (int i = 0; i < 2; ++i) {
    append<std::uint8_t>(bytes, 10);  // a line end among the numbers
    append<double>(bytes, 3.0 + i);
    append<float>(bytes, 1.5F);
    append<std::int16_t>(bytes, -2);
    append<float>(bytes, -2.0F);
  }
  const auto vertices = parse_vertices(bytes);
  ASSERT_EQ(vertices.size(), 2U);
  EXPECT_LT((vertices[1] - Eigen::Vector3d(0.0015, -0.002, 0.004)).norm(), 1e-15);
  EXPECT_INVALID(parse_vertices(bytes.substr(0, bytes.size() - 1)),
                 "m.ply: got the end of the file in vertex 1, expected 2 of them");
}

TEST(Ply, RefusesDamage) {
  EXPECT_INVALID(parse_vertices("plx\n"), "m.ply: got another first line, expected 'ply'");
  EXPECT_INVALID(parse_vertices(with(kAscii, "end_header", "end")),
                 "m.ply: got no line 'end_header', expected one");
  EXPECT_INVALID(parse_vertices(with(kAscii, "ascii", "binary_big_endian")),
                 "m.ply: got another format, expected ascii or binary_little_endian");
  EXPECT_INVALID(parse_vertices(with(kAscii, "float y", "float w")),
                 "m.ply: got vertices without x, y, z, expected all three");
  EXPECT_INVALID(parse_vertices(with(kAscii, "float y", "text y")),
                 "m.ply: got a property of type \"text\", expected a number");
  EXPECT_INVALID(parse_vertices(with(kAscii, "property uchar red", "property list uchar int red")),
                 "m.ply: got a vertex property that is a list, expected numbers");
  EXPECT_INVALID(
      parse_vertices(with(kAscii, "vertex 2", "vertex -2")),
      "m.ply: got \"element vertex -2\", expected 'element vertex' and a positive number");
  EXPECT_INVALID(parse_vertices(with(kAscii, "-4.5", "nan")),
                 "m.ply: got a damaged line of vertex 1, expected a number more");
  EXPECT_INVALID_WITH(parse_vertices(with(kAscii, "vertex 2", "vertex 9")),
                      "damaged line of vertex 3");
}

// --- faces

PlyMesh mesh(const std::string& bytes) { return parse_ply_mesh(bytes, "m.ply", 1e-3); }

const std::string kMeshHead =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFaces =
    "ply\nformat ascii 1.0\n" + kMeshHead +
    "element edge 1\nproperty int vertex1\nproperty int vertex2\nelement face 2\n"
    "property uchar flags\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1000 0 0\n1000 1000 0\n0 1000 0\n0 1\n7 3 2 1 0\n7 4 0 1 2 3\n";

TEST(PlyMesh, PolygonsBecomeFans) {
  const PlyMesh square = mesh(kFaces);
  ASSERT_EQ(square.vertices.size(), 4U);
  EXPECT_LT((square.vertices[2] - Eigen::Vector3d(1, 1, 0)).norm(), 1e-15);
  using Corners = std::array<std::uint32_t, 3>;
  EXPECT_EQ(square.triangles, (std::vector<Corners>{{2, 1, 0}, {0, 1, 2}, {0, 2, 3}}));
}

TEST(PlyMesh, BinaryFacesWithMoreLists) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\n" + kMeshHead +
                      "element face 1\nproperty list uchar uint vertex_index\n"
                      "property list uchar float texcoord\nend_header\n";
  for (int i = 0; i < 12; ++i) append<float>(bytes, static_cast<float>(i));
  append<std::uint8_t>(bytes, 3);
  for (const std::uint32_t corner : {3U, 0U, 2U}) append(bytes, corner);
  append<std::uint8_t>(bytes, 2);
  append<float>(bytes, 0.5F);
  append<float>(bytes, 0.5F);
  EXPECT_EQ(mesh(bytes).triangles, (std::vector<std::array<std::uint32_t, 3>>{{3, 0, 2}}));
  EXPECT_INVALID(mesh(bytes.substr(0, bytes.size() - 1)),
                 "m.ply: got the end of the file in face 0, expected 1 of them");
}

TEST(PlyMesh, RefusesDamage) {
  EXPECT_INVALID(mesh(with(kFaces, "7 3 2 1 0", "7 2 2 1")),
                 "m.ply: got face 0 of 2 corners, expected at least 3");
  EXPECT_INVALID(mesh(with(kFaces, "7 3 2 1 0", "7 3 2 1 4")),
                 "m.ply: got corner 4 of face 0, expected one of 4 vertices");
  EXPECT_INVALID(mesh(with(kFaces, "7 3 2 1 0", "7 3 2 1 0.5")),
                 "m.ply: got corner 0.5 of face 0, expected one of 4 vertices");
  EXPECT_INVALID(mesh(with(kFaces, "7 3 2 1 0", "7 -3 2 1 0")),
                 "m.ply: got a damaged line of face 0, expected a list of so many entries");
  EXPECT_INVALID(mesh(with(kFaces, "7 3 2 1 0", "7 3e33 2 1 0")),
                 "m.ply: got a damaged line of face 0, expected a list of so many entries");
  EXPECT_INVALID(mesh(with(kFaces, "7 3 2 1 0", "7 9 2 1 0")),
                 "m.ply: got a damaged line of face 0, expected a number more");
  EXPECT_INVALID(mesh(with(kFaces, "vertex_indices", "corners")),
                 "m.ply: got faces without a list 'vertex_indices', expected one");
  EXPECT_INVALID(mesh(with(kFaces, "element face 2", "element face 0")),
                 "m.ply: got no faces, expected some");
  EXPECT_INVALID(mesh(with(kFaces, "uchar int vertex", "float int vertex")),
                 "m.ply: got a list whose length is no integer, expected an integer");
  EXPECT_INVALID(mesh(with(kFaces, "property int vertex1\nproperty int vertex2\n", "")),
                 "m.ply: got an element without properties, expected some of \"edge\"");
}

}  // namespace
}  // namespace posemix
