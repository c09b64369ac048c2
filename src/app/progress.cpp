// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "progress.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace posemix {
namespace {

constexpr std::size_t kBarWidth = 30;
constexpr std::chrono::milliseconds kRedraw{100};

}  // namespace

bool on_terminal() { return isatty(STDERR_FILENO) == 1; }

std::string progress_text(std::size_t done, std::size_t total, double seconds) {
  const double share = total == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(total);
  const auto filled = static_cast<std::size_t>(share * static_cast<double>(kBarWidth));
  return fmt::format("[{:#<{}}{:.<{}}] {:3.0f} %  {}/{} frames  {:.1f} s", "", filled, "",
                     kBarWidth - filled, 100.0 * share, done, total, seconds);
}

ProgressBar::ProgressBar(bool shown) : shown_(shown) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::update(std::size_t done, std::size_t total) {
  const Clock::time_point now = Clock::now();
  if (!shown_ || now < next_) return;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const std::string text = fmt::format("\r{}\033[K", progress_text(done, total, seconds));
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
  drawn_ = true;
  next_ = now + kRedraw;
}

}  // namespace posemix
