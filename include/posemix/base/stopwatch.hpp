// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>

namespace posemix {

/// Measures durations by the steady clock.
class Stopwatch {
 public:
  /// The time since it was made or restarted [s].
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// The time since it was made or restarted [s]; from now on the time counts from zero.
  double restart() {
    const Clock::time_point now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace posemix
