// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The header of PLY files, before the numbers.
namespace posemix::internal {

enum class PlyNumber { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string_view name;
  PlyNumber type;
  std::optional<PlyNumber> length;  ///< for a list: type of its number of entries
};

struct PlyElement {
  std::string_view name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  /// The index of the property with this name, or the number of properties.
  std::size_t index_of(std::string_view property) const;
};

struct PlyHeader {
  bool is_binary = false;
  std::vector<PlyElement> elements;
  std::string_view body;  ///< the bytes after the line end_header
};

/// @throws InvalidInput `name: got ..., expected ...`
[[noreturn]] void fail_ply(const std::string& name, std::string_view got,
                           std::string_view expected);

/// Takes the bytes up to the next LF from the front of `bytes`, without that LF and a CR before it.
std::string_view take_line(std::string_view& bytes);

/// Reads the header of a file whose first element is `vertex`, with x, y and z and no lists. The
/// result refers to `bytes`.
PlyHeader parse_ply_header(std::string_view bytes, const std::string& name);

}  // namespace posemix::internal
