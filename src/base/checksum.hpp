// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace posemix::internal {

/// CRC-64/XZ (reflected ECMA-182): finds every change of up to 64 bits in a row.
inline std::uint64_t crc64(std::string_view bytes) {
  static constexpr auto kTable = [] {
    std::array<std::uint64_t, 256> table{};
    for (std::uint64_t i = 0; i < table.size(); ++i) {
      std::uint64_t value = i;
      for (int bit = 0; bit < 8; ++bit)
        value = (value >> 1U) ^ ((value & 1U) != 0 ? 0xC96C5795D7870F42U : 0U);
      table[i] = value;
    }
    return table;
  }();
  std::uint64_t value = ~std::uint64_t{0};
  for (const char byte : bytes)
    value = kTable[(value ^ static_cast<unsigned char>(byte)) & 0xFFU] ^ (value >> 8U);
  return ~value;
}

}  // namespace posemix::internal
