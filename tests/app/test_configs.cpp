// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "posemix/config/sequence_file.hpp"
#include "posemix/config/simulation_config.hpp"
#include "posemix/config/symmetries.hpp"
#include "posemix/testing/data.hpp"

namespace posemix {
namespace {

TEST(Configs, AllAreRead) {
  POSEMIX_REQUIRE_DATA();
  std::size_t sequences = 0;
  std::size_t simulations = 0;
  for (const auto& entry : std::filesystem::directory_iterator(POSEMIX_SOURCE_DIR "/configs")) {
    SCOPED_TRACE(entry.path());
    TomlDocument document = TomlDocument::load(entry.path());
    if (document.root().has("symmetries")) {
      EXPECT_FALSE(read_symmetry_file(entry.path()).empty());
    } else if (document.root().get_tables("objects")[0].has("detections")) {
      const SlamJob job = read_slam_job(document, data_folders(entry.path(), testing::data_dir()));
      EXPECT_GT(job.sequence.stamps.size(), 100U);
      ++sequences;
    } else {
      read_simulation(document);
      ++simulations;
    }
  }
  EXPECT_GE(sequences, 3U);
  EXPECT_GE(simulations, 1U);
}

}  // namespace
}  // namespace posemix
