// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace posemix::internal {

/// What is wrong: into the log, not too often, and into diagnostics for a while. Times are of a
/// clock that does not jump [s].
class Complaints {
 public:
  /// Takes a problem, which may last; returns whether it is for the log. The same at another stamp
  /// is the same.
  bool add(const std::string& why, double now_s, bool lasts = false);
  /// What was complained of lately, and what lasts.
  std::vector<std::string> recent(double now_s, double within_s);

 private:
  struct Problem {
    std::string why;
    double last_s;
    double logged_s;
    bool lasts;
  };
  std::map<std::string, Problem> problems_;
};

}  // namespace posemix::internal
