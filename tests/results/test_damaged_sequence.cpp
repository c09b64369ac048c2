// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <stdexcept>

#include <gtest/gtest.h>

#include "bounded_run.hpp"
#include "config/small_recording.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/results/results.hpp"
#include "posemix/testing/mutate.hpp"

/// Runs every step of `posemix slam` on damaged sequence files and recordings.
namespace posemix {
namespace {

using testing::fuzz;
using testing::FuzzReport;

constexpr std::size_t kInputs = 10000;
constexpr std::size_t kMostFrames = 6;

/// The small recording with only the object that has TUM detections.
std::string one_object() {
  const std::string text(testing::kSmallToml);
  const std::size_t begin = text.find("[[objects]]\nid = \"box\"");
  return text.substr(0, begin) + text.substr(text.find("[filter]"));
}

void expect_sound(const FuzzReport& report, std::size_t least_of_each) {
  EXPECT_TRUE(report.failures.empty())
      << report.failures.size() << " failures, the first: " << report.failures[0];
  EXPECT_GT(report.accepted, least_of_each);
  EXPECT_GT(report.rejected, least_of_each);
}

TEST(DamagedSequence, SequenceFiles) {
  const testing::SmallFolder small;
  const std::vector<std::string> originals{std::string(testing::kSmallToml)};
  const auto parse = [&](const std::string& text) {
    testing::run_first_frames(TomlDocument::parse(text, "s.toml"), small.folder.path(),
                              kMostFrames);
  };
  expect_sound(fuzz(originals, kInputs, 11, parse), 200);
}

TEST(DamagedSequence, TumFiles) {
  const testing::SmallFolder small;
  const std::vector<std::pair<std::string, std::string>> files{
      {"mug.txt", "objects.mug.detections.tum"},
      {"odometry.txt", "camera.odometry"},
      {"truth/0001.txt", "camera.ground_truth"},
      {"mug_truth.txt", "objects.mug.ground_truth.relative_tum"}};
  std::vector<std::string> originals;
  std::vector<TomlDocument> documents;
  for (const auto& [name, key] : files) {
    originals.push_back(testing::content_of(small.folder / name));
    documents.push_back(TomlDocument::parse(one_object(), "s.toml"));
    documents.back().apply_override(key + "=damaged.txt");
  }
  std::size_t next = 0;
  const auto parse = [&](const std::string& text) {
    small.folder.put("damaged.txt", text);
    testing::run_first_frames(documents[next++ % documents.size()], small.folder.path(),
                              kMostFrames);
  };
  expect_sound(fuzz(originals, kInputs, 12, parse), 300);
}

TEST(DamagedSequence, PosteriorFiles) {
  const testing::SmallFolder small;
  const SlamJob job =
      read_slam_job(TomlDocument::parse(testing::kSmallToml, "s.toml"), {small.folder.path()});
  const SlamRun slam = run(job.sequence, job.camera_prior, job.models, job.settings);
  PosteriorFile file = last_posterior(job, slam);
  const std::vector<std::string> originals{format_posterior(file)};
  const auto parse = [](const std::string& text) { parse_posterior(text, "p.json"); };
  expect_sound(fuzz(originals, kInputs / 5, 13, parse), 50);
}

}  // namespace
}  // namespace posemix
