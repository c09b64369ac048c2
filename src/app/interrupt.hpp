// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <csignal>
#include <stdexcept>
#include <string>

namespace posemix {

/// Thrown when the user or the system asked the program to stop.
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(int signal, const std::string& message = "interrupted")
      : std::runtime_error(message), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

/// During the lifetime of the guard, SIGINT and SIGTERM are recorded instead of ending the program;
/// a second signal ends it.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool interrupted() const;
  /// The number of the signal; zero if there was none.
  int signal() const;
  /// @throws Interrupted after a signal
  void check() const;

 private:
  struct sigaction before_int_ {};
  struct sigaction before_term_ {};
};

/// The number of the last signal that a guard recorded, which may be gone; zero if there was none.
int recorded_signal();

}  // namespace posemix
