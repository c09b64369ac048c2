// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>
#include <Eigen/Core>

#include "posemix/base/error.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/base/words.hpp"

/// The bytes of a saved state: numbers in little-endian order, one after the other, without names
/// (docs/state.md). What a class is made of is stated once, by StateFields, for both directions:
///
///  - `tie(x)` returns references to all that is saved. It names the members by a structured
///    binding, which does not compile when one is missing.
///  - `validate(x)`, where there is one, throws InvalidInput for what no object can be.
///  - `blank()`, for a class without a default constructor, makes any object to be overwritten.
///
/// A class that is made from what is saved has in place of `tie` the type `Stored`, `to_stored(x)`
/// and `of_stored(stored)`.
namespace posemix::internal {

template <class T>
concept StateNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <class T>
concept StateMatrix = std::derived_from<T, Eigen::DenseBase<T>>;

template <class T>
concept TiedState = requires(T& x) {
  StateFields<T>::tie(x);
};

template <class T>
concept ConvertedState = requires(const T& x) {
  StateFields<T>::to_stored(x);
};

/// An object to be overwritten.
template <class T>
T blank_state() {
  if constexpr (requires { StateFields<T>::blank(); }) {
    return StateFields<T>::blank();
  } else {
    return T{};
  }
}

[[noreturn]] inline void refuse_state(const std::string& what) {
  throw InvalidInput("the state is damaged: " + what);
}

inline void require_state(bool condition, const char* expected) {
  if (!condition) refuse_state(fmt::format("expected {}", expected));
}

/// The bytes of a number, and back.
template <class T>
std::array<char, sizeof(T)> bytes_of(const T& number) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(number);
  if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(bytes);
  return bytes;
}

template <class T>
T number_of(std::string_view bytes) {
  std::array<char, sizeof(T)> own;
  std::memcpy(own.data(), bytes.data(), sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(own);
  return std::bit_cast<T>(own);
}

}  // namespace posemix::internal
