// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/temporary_folder.hpp"
#include "posemix/config/data_folder.hpp"
#include "posemix/config/sequence_file.hpp"

/// Simulated recordings as files, and as they are read again.
namespace posemix::testing {

/// The job of a sequence file among files by name.
inline SlamJob job_from(const std::map<std::string, std::string>& files) {
  const TemporaryFolder folder;
  for (const auto& [name, content] : files) folder.put(name, content);
  const std::filesystem::path path = folder / "sequence.toml";
  return read_slam_job(TomlDocument::load(path), data_folders(path));
}

inline void expect_same_poses(const std::vector<std::optional<SE3d>>& actual,
                              const std::vector<std::optional<SE3d>>& expected,
                              const std::string& name) {
  ASSERT_EQ(actual.size(), expected.size()) << name;
  for (std::size_t k = 0; k < actual.size(); ++k) {
    ASSERT_EQ(actual[k].has_value(), expected[k].has_value()) << name << " frame " << k;
    if (!actual[k]) continue;
    EXPECT_TRUE(actual[k]->is_approx(*expected[k], 1e-9)) << name << " frame " << k;
  }
}

}  // namespace posemix::testing
