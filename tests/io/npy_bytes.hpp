// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <bit>
#include <cstdint>
#include <string>

#include <Eigen/Core>

namespace posemix::testing {

/// Layout of a matrix that npy_bytes writes.
struct NpyForm {
  int version = 1;
  bool fortran = false;
  bool wide = false;        ///< 64-bit floats
  std::string header = {};  ///< in place of the right one
};

/// `bits`' lowest bytes, least significant first.
inline std::string little_endian(std::uint64_t bits, int bytes) {
  std::string result;
  for (int i = 0; i < bytes; ++i) result += static_cast<char>((bits >> (8 * i)) & 0xff);
  return result;
}

/// The bytes of a .npy file as NumPy writes it (header padded to a multiple of 64).
inline std::string npy_bytes(const Eigen::Matrix4d& matrix, const NpyForm& form) {
  const int length_bytes = form.version == 1 ? 2 : 4;
  std::string header = form.header;
  if (header.empty()) {
    header = std::string("{'descr': '") + (form.wide ? "<f8" : "<f4") +
             "', 'fortran_order': " + (form.fortran ? "True" : "False") + ", 'shape': (4, 4), }";
    const std::size_t before = 8 + static_cast<std::size_t>(length_bytes);
    while ((before + header.size() + 1) % 64 != 0) header += ' ';
    header += '\n';
  }
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(form.version);
  bytes += '\0';
  bytes += little_endian(header.size(), length_bytes) + header;
  for (int i = 0; i < 16; ++i) {
    const double entry = form.fortran ? matrix(i % 4, i / 4) : matrix(i / 4, i % 4);
    bytes += form.wide ? little_endian(std::bit_cast<std::uint64_t>(entry), 8)
                       : little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(entry)), 4);
  }
  return bytes;
}

}  // namespace posemix::testing
