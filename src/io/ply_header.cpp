// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "ply_header.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

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
  fail_ply(name, fmt::format("a property of type {}", in_quotes(word)), "a number");
}

/// Reads a line `property TYPE NAME` or `property list TYPE TYPE NAME`.
PlyProperty ply_property(const std::vector<std::string_view>& words, const std::string& name) {
  if (words.size() == 3) return {words[2], ply_type(words[1], name), {}};
  if (words.size() != 5 || words[1] != "list") {
    fail_ply(name, "a damaged line of a property", "'property TYPE NAME', or a list");
  }
  const PlyNumber length = ply_type(words[2], name);
  if (length == PlyNumber::float32 || length == PlyNumber::float64) {
    fail_ply(name, "a list whose length is no integer", "an integer");
  }
  return {words[4], ply_type(words[3], name), length};
}

PlyElement ply_element(const std::vector<std::string_view>& words, std::string_view line,
                       bool is_first, const std::string& name) {
  const auto count = parse_integer(words[2]);
  if (is_first && (words[1] != "vertex" || !count || *count < 1)) {
    fail_ply(name, in_quotes(line), "'element vertex' and a positive number");
  }
  if (!count || *count < 0) fail_ply(name, in_quotes(line), "a number of elements");
  return {words[1], static_cast<std::size_t>(*count), {}};
}

/// Sets the format of the header; false if the format is not supported.
bool set_format(std::string_view format, PlyHeader& header) {
  header.is_binary = format == "binary_little_endian";
  return header.is_binary || format == "ascii";
}

void check_vertices(const PlyHeader& header, const std::string& name) {
  if (header.elements.empty()) fail_ply(name, "no element", "vertices");
  const PlyElement& vertex = header.elements.front();
  for (const PlyProperty& property : vertex.properties) {
    if (property.length) fail_ply(name, "a vertex property that is a list", "numbers");
  }
  for (const std::string_view axis : {"x", "y", "z"}) {
    if (vertex.index_of(axis) == vertex.properties.size()) {
      fail_ply(name, "vertices without x, y, z", "all three");
    }
  }
}

}  // namespace

std::size_t PlyElement::index_of(std::string_view property) const {
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [&](const PlyProperty& each) { return each.name == property; });
  return static_cast<std::size_t>(found - properties.begin());
}

void fail_ply(const std::string& name, std::string_view got, std::string_view expected) {
  throw InvalidInput(fmt::format("{}: got {}, expected {}", name, got, expected));
}

std::string_view take_line(std::string_view& bytes) {
  const std::size_t end = bytes.find('\n');
  std::string_view line = bytes.substr(0, end);
  bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

PlyHeader parse_ply_header(std::string_view bytes, const std::string& name) {
  if (take_line(bytes) != "ply") fail_ply(name, "another first line", "'ply'");
  PlyHeader header;
  bool has_format = false;
  for (std::string_view line = take_line(bytes); line != "end_header"; line = take_line(bytes)) {
    if (bytes.empty()) fail_ply(name, "no line 'end_header'", "one");
    const std::vector<std::string_view> words = split_words(line);
    if (words.size() == 3 && words[0] == "format") {
      has_format = set_format(words[1], header);
    } else if (words.size() == 3 && words[0] == "element") {
      header.elements.push_back(ply_element(words, line, header.elements.empty(), name));
    } else if (words.size() >= 2 && words[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(ply_property(words, name));
    }
  }
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) {
      fail_ply(name, "an element without properties", "some of " + in_quotes(element.name));
    }
  }
  if (!has_format) fail_ply(name, "another format", "ascii or binary_little_endian");
  check_vertices(header, name);
  header.body = bytes;
  return header;
}

}  // namespace posemix::internal
