// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdlib>

/// Included before every source of a build for mutation tests (tools/mutation_test): the mutant
/// that a process runs, -1 for none.
inline const int kMutant = [] {
  const char* chosen = std::getenv("POSEMIX_MUTANT");
  return chosen == nullptr ? -1 : std::atoi(chosen);
}();

inline bool posemix_mutant(int which) { return which == kMutant; }
