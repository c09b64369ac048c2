// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

namespace posemix {

/// Whether the standard error is a terminal.
bool on_terminal();

/// The text of a progress bar: `[#####.....]  50 %  576/1152 frames  3.2 s`.
std::string progress_text(std::size_t done, std::size_t total, double seconds,
                          std::string_view unit);

/// Shows progress on the standard error: on a terminal by a bar that is redrawn in place and erased
/// at the end of the scope, elsewhere not at all or by a line now and then.
class ProgressReport {
 public:
  /// Shows nothing unless `shown`, and off terminals only with `lines`: the ranks of an MPI job
  /// write to a pipe even when a person is waiting at the end of it.
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
