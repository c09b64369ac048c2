// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "posemix/io/sequence_file.hpp"
#include "posemix/io/simulation_config.hpp"
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
    if (document.root().get_tables("objects")[0].has("detections")) {
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

TEST(Configs, TheTemplateFitsEveryPairFromBothFolders) {
  POSEMIX_REQUIRE_DATA();
  const auto data = *testing::data_dir();
  std::size_t pairs = 0;
  for (const auto& object :
       std::filesystem::directory_iterator(data / "slam-super-6d/experiments/ycbv/inference")) {
    for (const auto& file : std::filesystem::directory_iterator(object.path() / "Initial")) {
      TomlDocument document = TomlDocument::load(POSEMIX_SOURCE_DIR "/configs/ycbv-dope.toml");
      document.apply_override("object=" + object.path().filename().string());
      document.apply_override("sequence=" + file.path().stem().string());
      const bool even = pairs % 2 == 0;
      const SlamJob job = read_slam_job(document, {even ? data : data / "slam-super-6d"});
      EXPECT_EQ(job.models[0].id, object.path().filename().string());
      EXPECT_EQ(job.sequence.stamps.size(), job.sequence.objects[0].detections.size());
      ++pairs;
    }
  }
  EXPECT_EQ(pairs, 30U);
}

}  // namespace
}  // namespace posemix
