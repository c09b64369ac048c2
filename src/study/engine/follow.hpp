// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "ranks.hpp"
#include "run_study.hpp"
#include "study.hpp"

namespace posemix {

/// The time for which a rank waits for its own threads before it looks for messages.
inline constexpr std::chrono::milliseconds kPatience{1};

std::size_t threads_of(const Ranks& ranks, const StudyRunOptions& options);

/// What must be the same on all ranks: the first message of a rank.
struct Agreement {
  std::string instructions;  ///< its vector instructions
  std::string settings;      ///< of its study, a line

  std::string text() const { return instructions + "\n" + settings; }
  static Agreement of(const std::string& text);
};

/// The work of any rank but rank 0: items that rank 0 hands out, until it says stop.
void follow(Ranks& ranks, const std::function<Study()>& make, const StudyRunOptions& options);

}  // namespace posemix
