// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <type_traits>
#include <utility>

namespace posemix {

/// The words for the values of an enum, in the order in which messages list them.
template <class Enum, std::size_t Size>
using WordTable = std::array<std::pair<std::string_view, Enum>, Size>;

/// The words for the values of an enum in files and on the command line. An enum that users write
/// down specialises this table beside its definition, with one word for every value.
template <class Enum>
inline constexpr WordTable<Enum, 0> words{};

/// An enum that has words.
template <class Enum>
concept Spelled = std::is_enum_v<Enum> && !words<Enum>.empty();

/// The word for a value; empty if the table has none.
template <Spelled Enum>
constexpr std::string_view word_of(Enum value) {
  for (const auto& [word, other] : words<Enum>) {
    if (other == value) return word;
  }
  return {};
}

}  // namespace posemix
