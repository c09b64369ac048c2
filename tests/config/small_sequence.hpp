// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/config/sequence_file.hpp"
#include "small_recording.hpp"

namespace posemix::testing {

/// Reads sequence files like kSmallToml, with the recording that they name.
class SmallSequence : public ::testing::Test {
 protected:
  SlamJob read(const std::string& text, const std::vector<std::string>& overrides = {}) {
    TomlDocument document = TomlDocument::parse(text, "s.toml");
    for (const std::string& each : overrides) document.apply_override(each);
    return read_slam_job(document, {small_.folder.path()});
  }
  SlamJob read_with(const std::vector<std::string>& overrides) {
    return read(std::string(kSmallToml), overrides);
  }
  SlamJob read_changed(std::string_view old, std::string_view by) {
    return read(replaced(std::string(kSmallToml), old, by));
  }

  SmallFolder small_;
};

}  // namespace posemix::testing
