// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The elements that a MATLAB file of version 5 is made of ("MAT-File Format", The MathWorks): a
/// type, a size, and that many bytes, which are numbers of that type, or elements again.
namespace posemix::internal {

/// Bytes of type and size before the data.
inline constexpr std::size_t kMatTag = 8;

enum class MatType : std::uint32_t {
  int8 = 1,
  uint8 = 2,
  int16 = 3,
  uint16 = 4,
  int32 = 5,
  uint32 = 6,
  single_precision = 7,
  double_precision = 9,
  int64 = 12,
  uint64 = 13,
  matrix = 14,
  compressed = 15,
};

struct MatElement {
  MatType type;
  std::string_view data;

  /// The bytes as numbers; none where the type is not one of numbers, or the last is cut off.
  std::optional<std::vector<double>> numbers(bool little_endian) const;
};

/// Takes the first element off `bytes`; none where they end before it does, or are empty.
std::optional<MatElement> take_element(std::string_view& bytes, bool little_endian);

struct Inflated {
  std::string bytes;
  bool is_whole;  ///< whether the stream ended there, with the right checksum
};

/// The first bytes of what zlib's stream holds, at most `most`; fewer where the stream is cut off,
/// and none where it is damaged.
std::optional<Inflated> inflated_prefix(std::string_view stream, std::size_t most);

}  // namespace posemix::internal
