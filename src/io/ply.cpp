// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/ply.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

static_assert(std::endian::native == std::endian::little,
              "binary PLY is read as it lies in memory");

enum class PlyNumber { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyHeader {
  bool is_binary = false;
  std::size_t vertices = 0;
  std::vector<PlyNumber> types;                   ///< of a vertex's properties
  std::array<std::ptrdiff_t, 3> xyz{-1, -1, -1};  ///< which of them
  std::string_view body;                          ///< after the line end_header
};

[[noreturn]] void fail_ply(const std::string& name, std::string_view got,
                           std::string_view expected) {
  throw InvalidInput(fmt::format("{}: got {}, expected {}", name, got, expected));
}

/// The bytes up to the next LF, which is taken away with a CR before it.
std::string_view take_line(std::string_view& bytes) {
  const std::size_t end = bytes.find('\n');
  std::string_view line = bytes.substr(0, end);
  bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

PlyNumber ply_type(std::string_view word, const std::string& name) {
  constexpr std::array<std::pair<std::string_view, PlyNumber>, 16> kTypes{
      {{"char", PlyNumber::int8},
       {"int8", PlyNumber::int8},
       {"uchar", PlyNumber::uint8},
       {"uint8", PlyNumber::uint8},
       {"short", PlyNumber::int16},
       {"int16", PlyNumber::int16},
       {"ushort", PlyNumber::uint16},
       {"uint16", PlyNumber::uint16},
       {"int", PlyNumber::int32},
       {"int32", PlyNumber::int32},
       {"uint", PlyNumber::uint32},
       {"uint32", PlyNumber::uint32},
       {"float", PlyNumber::float32},
       {"float32", PlyNumber::float32},
       {"double", PlyNumber::float64},
       {"float64", PlyNumber::float64}}};
  for (const auto& [key, type] : kTypes)
    if (key == word) return type;
  fail_ply(name, fmt::format("a vertex property of type {}", in_quotes(word)), "a number");
}

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

void add_property(PlyHeader& header, const std::vector<std::string_view>& words,
                  const std::string& name) {
  if (words.size() != 3) fail_ply(name, "a vertex property that is a list", "numbers");
  const auto at = static_cast<std::ptrdiff_t>(header.types.size());
  if (words[2] == "x") header.xyz[0] = at;
  if (words[2] == "y") header.xyz[1] = at;
  if (words[2] == "z") header.xyz[2] = at;
  header.types.push_back(ply_type(words[1], name));
}

PlyHeader parse_header(std::string_view bytes, const std::string& name) {
  if (take_line(bytes) != "ply") fail_ply(name, "another first line", "'ply'");
  PlyHeader header;
  std::size_t elements = 0;
  bool has_format = false;
  for (std::string_view line = take_line(bytes); line != "end_header"; line = take_line(bytes)) {
    if (bytes.empty()) fail_ply(name, "no line 'end_header'", "one");
    const std::vector<std::string_view> words = split_words(line);
    if (words.size() == 3 && words[0] == "format") {
      has_format = words[1] == "ascii" || words[1] == "binary_little_endian";
      header.is_binary = words[1] == "binary_little_endian";
    } else if (words.size() == 3 && words[0] == "element") {
      const auto count = parse_integer(words[2]);
      ++elements;
      if (elements > 1) continue;
      if (words[1] != "vertex" || !count || *count < 1)
        fail_ply(name, in_quotes(line), "'element vertex' and a positive number");
      header.vertices = static_cast<std::size_t>(*count);
    } else if (words.size() >= 2 && words[0] == "property" && elements == 1) {
      add_property(header, words, name);
    }
  }
  if (!has_format) fail_ply(name, "another format", "ascii or binary_little_endian");
  for (const std::ptrdiff_t at : header.xyz)
    if (at < 0) fail_ply(name, "vertices without x, y, z", "all three");
  header.body = bytes;
  return header;
}

/// The x, y, z of one vertex, which is taken from the body.
Eigen::Vector3d take_vertex(PlyHeader& header, std::size_t index, const std::string& name) {
  std::vector<double> numbers(header.types.size());
  if (header.is_binary) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::size_t size = size_of(header.types[i]);
      if (header.body.size() < at + size)
        fail_ply(name, fmt::format("{} vertices", index), fmt::format("{}", header.vertices));
      numbers[i] = binary_number(header.types[i], header.body.data() + at);
      at += size;
    }
    header.body.remove_prefix(at);
  } else {
    const std::vector<std::string_view> words = split_words(take_line(header.body));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const auto number = i < words.size() ? parse_number(words[i]) : std::nullopt;
      if (!number)
        fail_ply(name, fmt::format("a damaged line of vertex {}", index),
                 fmt::format("{} numbers", numbers.size()));
      numbers[i] = *number;
    }
  }
  Eigen::Vector3d vertex;
  for (std::size_t i = 0; i < 3; ++i)
    vertex[static_cast<Eigen::Index>(i)] = numbers[static_cast<std::size_t>(header.xyz[i])];
  if (!vertex.allFinite()) fail_ply(name, fmt::format("vertex {} not finite", index), "numbers");
  return vertex;
}

}  // namespace

std::vector<Eigen::Vector3d> parse_ply_vertices(std::string_view bytes, const std::string& name,
                                                double unit_m) {
  PlyHeader header = parse_header(bytes, name);
  std::vector<Eigen::Vector3d> vertices;
  for (std::size_t i = 0; i < header.vertices; ++i)
    vertices.emplace_back(unit_m * take_vertex(header, i, name));
  return vertices;
}

std::vector<Eigen::Vector3d> read_ply_vertices(const std::filesystem::path& path, double unit_m) {
  return parse_ply_vertices(read_file(path), path.string(), unit_m);
}

}  // namespace posemix
