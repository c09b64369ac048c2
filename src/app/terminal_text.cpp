// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "terminal_text.hpp"

#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

namespace posemix {
namespace {

/// A character of UTF-8 at the start of a text; of size 1 and no value where there is none.
struct Character {
  std::size_t size = 1;
  std::uint32_t value = 0xFFFFFFFF;
};

Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return {1, lead};
  const std::size_t size = lead < 0xC2   ? 0
                           : lead < 0xE0 ? 2
                           : lead < 0xF0 ? 3
                           : lead < 0xF5 ? 4
                                         : 0;
  if (size == 0 || text.size() < size) return {};
  std::uint32_t value = lead & (0xFFU >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return {};
    value = (value << 6U) | (byte(i) & 0x3FU);
  }
  constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = value >= 0xD800 && value <= 0xDFFF;
  if (value < kSmallest[size] || value > 0x10FFFF || is_surrogate) return {};
  return {size, value};
}

bool is_harmless(std::uint32_t value) {
  const auto within = [&](std::uint32_t first, std::uint32_t last) {
    return value >= first && value <= last;
  };
  const bool is_control = value < 0x20 || within(0x7F, 0x9F);
  const bool turns = within(0x200E, 0x200F) || within(0x2028, 0x202E) || within(0x2066, 0x2069);
  return value <= 0x10FFFF && !is_control && !turns;
}

std::string escaped(std::string_view text, std::string_view kept) {
  std::string safe;
  while (!text.empty()) {
    const Character first = first_character(text);
    const std::string_view bytes = text.substr(0, first.size);
    if (is_harmless(first.value) || kept.find(bytes) != std::string_view::npos) {
      safe += bytes;
    } else {
      for (const char byte : bytes)
        safe += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    }
    text.remove_prefix(first.size);
  }
  return safe;
}

}  // namespace

std::string terminal_text(std::string_view text) { return escaped(text, "\t\n"); }

std::string terminal_line(std::string_view text) { return escaped(text, ""); }

}  // namespace posemix
