// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cerrno>

namespace posemix::internal {

/// Makes a call of the system until no signal interrupts it, which can happen on a file system over
/// a network; returns what it returns.
template <class Call>
auto uninterrupted(const Call& call) {
  while (true) {
    const auto result = call();
    if (result >= 0 || errno != EINTR) return result;
  }
}

}  // namespace posemix::internal
