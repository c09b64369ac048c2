// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <stdexcept>
#include <string>

namespace posemix {

/// Invalid input: the message names the value (file, line or key where there is one) and what was
/// expected.
class InvalidInput : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Throws InvalidInput with `message` unless `condition` holds.
inline void require(bool condition, const char* message) {
  if (!condition) throw InvalidInput(message);
}

namespace internal {

/// Tag of the constructors that take their arguments unchecked.
struct Unchecked {};

}  // namespace internal

}  // namespace posemix
