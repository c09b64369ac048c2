// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "posemix/config/sequence_file.hpp"
#include "posemix/results/results.hpp"
#include "posemix/testing/data.hpp"

/// configs/ycbv-dope.toml on every pair of object and sequence of the data folder, with default
/// settings.
namespace posemix {
namespace {

SlamJob read_pair(const std::filesystem::path& detections, const std::filesystem::path& data) {
  TomlDocument document = TomlDocument::load(POSEMIX_SOURCE_DIR "/configs/ycbv-dope.toml");
  const std::string object = detections.parent_path().parent_path().filename().string();
  document.apply_override("object=" + object);
  document.apply_override("sequence=" + detections.stem().string());
  SlamJob job = read_slam_job(document, {data});
  EXPECT_EQ(job.models[0].id, object);
  return job;
}

void expect_results(const SlamJob& job) {
  const SlamRun slam = run(job.sequence, job.camera_prior, job.models, job.settings);
  const Metrics metrics = evaluate(job.sequence, slam);
  EXPECT_EQ(slam.frames.size(), job.sequence.stamps.size());
  EXPECT_EQ(format_results(job, slam, metrics).size(), 8U);
  EXPECT_TRUE(metrics.camera.position_rmse_m.has_value());
  EXPECT_TRUE(metrics.objects[0].world.rotation_rmse_deg.has_value());
  EXPECT_TRUE(metrics.objects[0].relative.rotation_rmse_deg.has_value());
}

TEST(DopePairs, EveryPairRunsFromBothDataFolders) {
  POSEMIX_REQUIRE_DATA();
  const auto data = *testing::data_dir();
  std::size_t pairs = 0;
  for (const auto& object :
       std::filesystem::directory_iterator(data / "slam-super-6d/experiments/ycbv/inference")) {
    for (const auto& file : std::filesystem::directory_iterator(object.path() / "Initial")) {
      SCOPED_TRACE(file.path());
      expect_results(read_pair(file.path(), pairs % 2 == 0 ? data : data / "slam-super-6d"));
      ++pairs;
    }
  }
  EXPECT_EQ(pairs, 30U);
}

}  // namespace
}  // namespace posemix
