// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

namespace posemix {

/// True where the standard error is a terminal.
bool on_terminal();

/// The text of a progress bar: `[#####.....]  50 %  576/1152 frames  3.2 s`.
std::string progress_text(std::size_t done, std::size_t total, double seconds,
                          std::string_view unit);

/// Tells on the standard error how far the program is: by a bar that is drawn over itself and
/// erased at the end of its scope where that is a terminal; elsewhere by nothing or by a line now
/// and then.
class ProgressReport {
 public:
  /// Says nothing unless `shown`, and off terminals nothing unless `lines` is set: the ranks of
  /// an MPI job write to a pipe even when a person is waiting at the end of it.
  ProgressReport(bool shown, std::string_view unit, bool lines = false);
  ~ProgressReport();
  ProgressReport(const ProgressReport&) = delete;
  ProgressReport& operator=(const ProgressReport&) = delete;

  void update(std::size_t done, std::size_t total);

 private:
  using Clock = std::chrono::steady_clock;

  enum class Style { none, bar, lines };

  Style style_;
  std::string unit_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_ = start_;
};

}  // namespace posemix
