// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cerrno>
#include <string>
#include <system_error>

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

/// For a call that may wait for ever, as for a pipe that nobody reads or writes: a signal ends it.
/// @throws std::system_error with std::errc::interrupted when `error` is EINTR
inline void throw_if_interrupted(int error, const std::string& what) {
  if (error == EINTR) throw std::system_error(EINTR, std::generic_category(), what);
}

}  // namespace posemix::internal
