// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What stands before the numbers of a PLY file.
namespace posemix::internal {

enum class PlyNumber { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string_view name;
  PlyNumber type;
  std::optional<PlyNumber> length;  ///< of a list: the type of the number of its entries
};

struct PlyElement {
  std::string_view name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  /// Index of the property of that name, or the number of properties.
  std::size_t index_of(std::string_view property) const;
};

struct PlyHeader {
  bool is_binary = false;
  std::vector<PlyElement> elements;
  std::string_view body;  ///< after the line end_header
};

/// Throws InvalidInput `name: got ..., expected ...`.
[[noreturn]] void fail_ply(const std::string& name, std::string_view got,
                           std::string_view expected);

/// The bytes up to the next LF, which is taken away with a CR before it.
std::string_view take_line(std::string_view& bytes);

/// The header of a file whose first element is `vertex`, with x, y and z and no lists. It refers to
/// `bytes`.
PlyHeader parse_ply_header(std::string_view bytes, const std::string& name);

}  // namespace posemix::internal
