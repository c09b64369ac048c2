// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <stdexcept>
#include <string>

namespace posemix {

/// The exception for invalid input: its message names the value (with file, line or key if there is
/// one) and what was expected.
class InvalidInput : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Throws InvalidInput with `message` unless `condition` holds.
inline void require(bool condition, const char* message) {
  if (!condition) throw InvalidInput(message);
}

namespace internal {

/// Tag of constructors that do not check their arguments.
struct Unchecked {};

}  // namespace internal

}  // namespace posemix
