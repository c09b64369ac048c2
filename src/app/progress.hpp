// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace posemix {

/// True where the standard error is a terminal.
bool on_terminal();

/// The text of a progress bar: `[#####.....]  50 %  576/1152 frames  3.2 s`.
std::string progress_text(std::size_t done, std::size_t total, double seconds);

/// A bar on the standard error that is drawn over itself and erased at the end of its scope.
class ProgressBar {
 public:
  /// Draws nothing unless `shown`.
  explicit ProgressBar(bool shown);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::size_t done, std::size_t total);

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_ = start_;
};

}  // namespace posemix
