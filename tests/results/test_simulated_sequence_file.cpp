// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/results/simulation_folder.hpp"

/// What the sequence file of a simulation tells the filter.
namespace posemix {
namespace {

SlamJob job_of_files(const std::map<std::string, std::string>& files) {
  const testing::TemporaryFolder folder;
  for (const auto& [name, content] : files) folder.put(name, content);
  const std::filesystem::path path = folder / "sequence.toml";
  return read_slam_job(TomlDocument::load(path), data_folders(path));
}

/// The job of slam from the folder of a simulation of one object, with more of its table and with a
/// table [filter].
SlamJob job_with(const std::string& object, const std::string& filter) {
  const SimulationFile file = read_simulation(TomlDocument::parse(
      "schema = 1\n[camera]\nframes = 20\n[noise.n]\ncomponents = [{}]\n[noise.r]\ncomponents = "
      "[{frame = \"ray\", translation_sd_of_range = 0.01}]\n[[objects]]\nid = \"a\"\nnoise = "
      "\"n\"\n" +
          object + "\n[filter]\n" + filter,
      "sim.toml"));
  return job_of_files(format_simulation(file, simulate(file.config, 1), 1));
}

const std::optional<SlowError>& slow_in(const SlamJob& job) {
  return job.models[0].noise.dependence().slow;
}

TEST(SimulatedSequenceFile, SlowErrorsAreToldAsTheyAre) {
  EXPECT_FALSE(slow_in(job_with("slow = {}", "")).has_value());
  EXPECT_FALSE(slow_in(job_with("slow = {correlation_time_s = 3}", "")).has_value());
  const SlamJob constant = job_with(
      "slow = {rotation_sd_deg = 2, translation_sd_m = 0.01, correlation_time_s = inf, "
      "correlation_angle_deg = inf}",
      "");
  ASSERT_TRUE(slow_in(constant).has_value());
  EXPECT_TRUE(std::isinf(slow_in(constant)->correlation_time_s));
  EXPECT_TRUE(std::isinf(slow_in(constant)->correlation_angle_rad));
  EXPECT_NEAR(slow_in(constant)->covariance(5, 5), 1e-4, 1e-12);
  // A covariance that is regular, where some of the deviations are zero.
  const SlamJob turns = job_with("slow = {rotation_sd_deg = 2, correlation_angle_deg = 60}", "");
  EXPECT_NEAR(slow_in(turns)->covariance(0, 0), std::pow(radians(2.0), 2), 1e-12);
  EXPECT_NEAR(slow_in(turns)->covariance(4, 4), 1e-12, 1e-15);
  EXPECT_NE(testing::invalid_input_message([] {
              job_with("claimed_noise = \"r\"\nslow = {rotation_sd_deg = 2}", "");
            }).find("object 'a' has components of different frames"),
            std::string::npos);
}

TEST(SimulatedSequenceFile, FilterSettingsOfEveryKindReachTheJob) {
  const SlamJob learned = job_with("", "noise_scale_detections = inf\nmax_hypotheses = 3");
  const auto& multi = std::get<MultiObjectSlamSettings>(learned.settings.tracker).filter;
  EXPECT_TRUE(std::isinf(multi.noise_scale_detections));
  EXPECT_EQ(multi.max_hypotheses, 3U);
  const SlamJob particles = job_with(
      "", "method = \"rbpf\"\nparticles = 20\nparticle_walk_translation_sd_m = [0.1, 0.2, 0.3]");
  const auto& walk = std::get<ParticleFilterSettings>(particles.settings.tracker).object_walk;
  EXPECT_NEAR(walk.covariance(4, 4), 0.04, 1e-12);
  EXPECT_NEAR(walk.covariance(5, 5), 0.09, 1e-12);
}

TEST(SimulatedSequenceFile, EveryShippedConfigurationIsReadBack) {
  int simulated = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(POSEMIX_SOURCE_DIR) + "/configs")) {
    if (entry.path().extension() != ".toml") continue;
    std::optional<SimulationFile> file;
    try {
      file = read_simulation(TomlDocument::load(entry.path()));
    } catch (const InvalidInput&) {
      continue;  // a sequence file or symmetries
    }
    const SlamJob job = job_of_files(format_simulation(*file, simulate(file->config, 1), 1));
    EXPECT_EQ(job.sequence.stamps.size(), file->config.path.frames) << entry.path();
    ++simulated;
  }
  EXPECT_GE(simulated, 1);
}

}  // namespace
}  // namespace posemix
