// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

/// SHA-256 (FIPS 180-4), for files that tell which others belong to them. A library without a
/// network has no other use for a library of cryptography.
namespace posemix::internal {

class Sha256 {
 public:
  void add(std::string_view bytes);
  /// 64 hexadecimal digits of all bytes so far; nothing can be added afterwards.
  std::string digits();

 private:
  void take_block(const unsigned char* block);

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::string waiting_;      ///< fewer bytes than a block
  std::uint64_t bytes_ = 0;  ///< in all
};

std::string sha256_of(std::string_view bytes);

/// @throws InvalidInput naming the file when it cannot be read
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace posemix::internal
