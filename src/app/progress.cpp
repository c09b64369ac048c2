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
constexpr std::chrono::seconds kNextLine{5};

}  // namespace

bool on_terminal() { return isatty(STDERR_FILENO) == 1; }

std::string progress_text(std::size_t done, std::size_t total, double seconds,
                          std::string_view unit) {
  const double share = total == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(total);
  const auto filled = static_cast<std::size_t>(share * static_cast<double>(kBarWidth));
  return fmt::format("[{:#<{}}{:.<{}}] {:3.0f} %  {}/{} {}  {:.1f} s", "", filled, "",
                     kBarWidth - filled, 100.0 * share, done, total, unit, seconds);
}

ProgressReport::ProgressReport(bool shown, std::string_view unit, bool lines)
    : style_(!shown          ? Style::none
             : on_terminal() ? Style::bar
             : lines         ? Style::lines
                             : Style::none),
      unit_(unit) {
  if (style_ == Style::lines) next_ += kNextLine;
}

ProgressReport::~ProgressReport() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressReport::update(std::size_t done, std::size_t total) {
  const Clock::time_point now = Clock::now();
  if (style_ == Style::none || now < next_) return;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const std::string text = progress_text(done, total, seconds, unit_);
  const bool bar = style_ == Style::bar;
  const std::string line = bar ? fmt::format("\r{}\033[K", text) : fmt::format("{}\n", text);
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
  drawn_ = bar;
  next_ = now + (bar ? Clock::duration(kRedraw) : Clock::duration(kNextLine));
}

}  // namespace posemix
