// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace posemix::internal {

/// The content of the header of a .npy file.
struct NpyHeader {
  std::size_t size = 0;        ///< bytes before the data
  std::size_t entry_size = 0;  ///< 4 or 8 bytes per number
  bool fortran_order = false;  ///< column by column
  std::string shape_text;      ///< as in the file, such as "(4, 4)"
  std::vector<std::size_t> shape;
};

/// Reads the header at the start of `bytes`.
/// @throws InvalidInput unless it describes an array of little-endian 32- or 64-bit floats in
/// format version 1, 2 or 3
NpyHeader parse_npy_header(std::string_view bytes, const std::string& name);

/// A header for 64-bit floats in C order, padded as NumPy pads it.
std::string format_npy_header(const std::vector<std::size_t>& shape);

}  // namespace posemix::internal
