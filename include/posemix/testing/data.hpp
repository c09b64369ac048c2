// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

#include <gtest/gtest.h>

namespace posemix::testing {

/// The folder of recorded sequences, named by the environment variable POSEMIX_DATA; empty if that
/// is not a folder.
inline std::optional<std::filesystem::path> data_dir() {
  const char* named = std::getenv("POSEMIX_DATA");
  if (named == nullptr || !std::filesystem::is_directory(named)) return std::nullopt;
  return std::filesystem::path(named);
}

/// True in continuous integration (environment variable CI=true), where a missing data folder is a
/// failure.
inline bool data_is_mandatory() {
  const char* ci = std::getenv("CI");
  return ci != nullptr && std::string_view(ci) == "true";
}

}  // namespace posemix::testing

/// Ends the test if the recorded sequences are missing: skipped, or failed with CI=true.
#define POSEMIX_REQUIRE_DATA()                                                               \
  do {                                                                                       \
    if (!::posemix::testing::data_dir()) {                                                   \
      if (::posemix::testing::data_is_mandatory())                                           \
        FAIL() << "recorded sequences are mandatory here: set POSEMIX_DATA to their folder"; \
      GTEST_SKIP() << "no recorded sequences: set POSEMIX_DATA to their folder";             \
    }                                                                                        \
  } while (false)
