// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/ply.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "ply_header.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

static_assert(std::endian::native == std::endian::little,
              "binary PLY is read as it lies in memory");

std::size_t size_of(PlyNumber type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

template <typename Number>
double number_at(const char* bytes) {
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return static_cast<double>(number);
}

double binary_number(PlyNumber type, const char* bytes) {
  switch (type) {
    case PlyNumber::int8:
      return number_at<std::int8_t>(bytes);
    case PlyNumber::uint8:
      return number_at<std::uint8_t>(bytes);
    case PlyNumber::int16:
      return number_at<std::int16_t>(bytes);
    case PlyNumber::uint16:
      return number_at<std::uint16_t>(bytes);
    case PlyNumber::int32:
      return number_at<std::int32_t>(bytes);
    case PlyNumber::uint32:
      return number_at<std::uint32_t>(bytes);
    case PlyNumber::float32:
      return number_at<float>(bytes);
    case PlyNumber::float64:
      return number_at<double>(bytes);
  }
  return 0.0;
}

/// What the largest of the integer types counts to; a length may be written as any number.
constexpr double kMostEntries = 4294967295.0;

/// Takes the numbers of one element after another from the body of a file.
class PlyBody {
 public:
  PlyBody(const PlyHeader& header, const std::string& name)
      : body_(header.body), is_binary_(header.is_binary), name_(name) {}

  /// The numbers of every property; a list has as many as it states.
  const std::vector<std::vector<double>>& take(const PlyElement& element, std::size_t index) {
    element_ = &element;
    index_ = index;
    if (!is_binary_) {
      words_ = split_words(take_line(body_));
      word_ = 0;
    }
    values_.resize(element.properties.size());
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      const std::size_t length = property.length ? take_length(*property.length) : 1;
      values_[i].clear();
      for (std::size_t k = 0; k < length; ++k) values_[i].push_back(take_number(property.type));
    }
    return values_;
  }

 private:
  std::size_t take_length(PlyNumber type) {
    const double length = take_number(type);
    if (!(length >= 0.0 && length <= kMostEntries) || length != std::floor(length))
      fail("a list of so many entries");
    return static_cast<std::size_t>(length);
  }

  double take_number(PlyNumber type) {
    if (!is_binary_) {
      const auto number = word_ < words_.size() ? parse_number(words_[word_++]) : std::nullopt;
      if (!number) fail("a number more");
      return *number;
    }
    const std::size_t size = size_of(type);
    if (body_.size() < size) {
      fail_ply(name_, fmt::format("the end of the file in {} {}", element_->name, index_),
               fmt::format("{} of them", element_->count));
    }
    const double number = binary_number(type, body_.data());
    body_.remove_prefix(size);
    return number;
  }

  [[noreturn]] void fail(std::string_view expected) const {
    fail_ply(name_, fmt::format("a damaged line of {} {}", element_->name, index_), expected);
  }

  std::string_view body_;
  bool is_binary_;
  const std::string& name_;
  const PlyElement* element_ = nullptr;
  std::size_t index_ = 0;
  std::vector<std::string_view> words_;  ///< the words of the current line
  std::size_t word_ = 0;
  std::vector<std::vector<double>> values_;
};

std::vector<Eigen::Vector3d> take_vertices(PlyBody& body, const PlyElement& element,
                                           const std::string& name, double unit_m) {
  const std::array<std::size_t, 3> xyz{element.index_of("x"), element.index_of("y"),
                                       element.index_of("z")};
  std::vector<Eigen::Vector3d> vertices;
  for (std::size_t i = 0; i < element.count; ++i) {
    const auto& values = body.take(element, i);
    const Eigen::Vector3d vertex(values[xyz[0]][0], values[xyz[1]][0], values[xyz[2]][0]);
    if (!vertex.allFinite()) fail_ply(name, fmt::format("vertex {} not finite", i), "numbers");
    vertices.emplace_back(unit_m * vertex);
  }
  return vertices;
}

/// Adds a face as a fan of triangles.
void add_face(PlyMesh& mesh, const std::vector<double>& corners, std::size_t face,
              const std::string& name) {
  if (corners.size() < 3) {
    fail_ply(name, fmt::format("face {} of {} corners", face, corners.size()), "at least 3");
  }
  std::vector<std::uint32_t> indices;
  for (const double corner : corners) {
    if (!(corner >= 0.0 && corner < static_cast<double>(mesh.vertices.size())) ||
        corner != std::floor(corner)) {
      fail_ply(name, fmt::format("corner {} of face {}", corner, face),
               fmt::format("one of {} vertices", mesh.vertices.size()));
    }
    indices.push_back(static_cast<std::uint32_t>(corner));
  }
  for (std::size_t i = 2; i < indices.size(); ++i) {
    mesh.triangles.push_back({indices[0], indices[i - 1], indices[i]});
  }
}

std::size_t index_of_corners(const PlyElement& face, const std::string& name) {
  std::size_t at = face.index_of("vertex_indices");
  if (at == face.properties.size()) at = face.index_of("vertex_index");
  if (at == face.properties.size() || !face.properties[at].length) {
    fail_ply(name, "faces without a list 'vertex_indices'", "one");
  }
  return at;
}

}  // namespace

std::vector<Eigen::Vector3d> parse_ply_vertices(std::string_view bytes, const std::string& name,
                                                double unit_m) {
  const PlyHeader header = parse_ply_header(bytes, name);
  PlyBody body(header, name);
  return take_vertices(body, header.elements.front(), name, unit_m);
}

PlyMesh parse_ply_mesh(std::string_view bytes, const std::string& name, double unit_m) {
  const PlyHeader header = parse_ply_header(bytes, name);
  PlyBody body(header, name);
  PlyMesh mesh;
  mesh.vertices = take_vertices(body, header.elements.front(), name, unit_m);
  if (mesh.vertices.size() > std::numeric_limits<std::uint32_t>::max()) {
    fail_ply(name, fmt::format("{} vertices", mesh.vertices.size()), "fewer");
  }
  for (std::size_t i = 1; i < header.elements.size(); ++i) {
    const PlyElement& element = header.elements[i];
    const bool is_face = element.name == "face";
    const std::size_t corners = is_face ? index_of_corners(element, name) : 0;
    for (std::size_t k = 0; k < element.count; ++k) {
      const auto& values = body.take(element, k);
      if (is_face) add_face(mesh, values[corners], k, name);
    }
    if (is_face) break;
  }
  if (mesh.triangles.empty()) fail_ply(name, "no faces", "some");
  return mesh;
}

PlyMesh read_ply_mesh(const std::filesystem::path& path, double unit_m) {
  return parse_ply_mesh(read_file(path), path.string(), unit_m);
}

}  // namespace posemix
