// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <bit>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "posemix/lie/lie.hpp"

namespace posemix {

/// FNV-1a over the bits of numbers, poses and texts: names the data of a study in its settings, so
/// that a study is not resumed on other data.
class Fingerprint {
 public:
  void add(std::uint64_t bits) {
    for (int shift = 0; shift < 64; shift += 8) add_byte(bits >> shift);
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  /// The quaternion, then the translation.
  void add(const SE3d& pose) {
    for (const double q : pose.rotation().quaternion().coeffs()) add(q);
    for (const double t : pose.translation()) add(t);
  }
  void add(const std::string& text) {
    add(std::uint64_t{text.size()});
    for (const char c : text) add_byte(static_cast<unsigned char>(c));
  }

  /// Sixteen hexadecimal digits.
  std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  void add_byte(std::uint64_t byte) { hash_ = (hash_ ^ (byte & 0xffU)) * 0x100000001b3ULL; }

  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace posemix
