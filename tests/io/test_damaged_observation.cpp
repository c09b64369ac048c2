// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <stdexcept>

#include <gtest/gtest.h>

#include "posemix/io/observation_csv.hpp"
#include "posemix/io/observation_jsonl.hpp"
#include "posemix/testing/mutate.hpp"

/// Damaged tables and lines of observations.
namespace posemix {
namespace {

std::vector<Observation> some_observations() {
  Observation tag;
  tag.object = "7";
  tag.camera = "left";
  tag.stamp_s = 1.5;
  tag.score = 0.25;
  tag.components = {{.weight = 0.75,
                     .pose = SE3d(SO3d::exp({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}),
                     .covariance = Matrix6d(1e-4 * Matrix6d::Identity())},
                    {.weight = 0.25, .pose = SE3d()}};
  Observation mug;
  mug.class_id = "mug";
  mug.components = {{.pose = SE3d()}};
  return {tag, mug};
}

/// Reads damaged texts, writes what was accepted and reads it again.
template <typename Parse, typename Format>
void fuzz_observations(const Parse& parse_text, const Format& format) {
  const std::vector<std::string> originals{format(some_observations())};
  const auto parse = [&](const std::string& text) {
    const auto read = parse_text(text, "o");
    const auto again = parse_text(format(read), "o");
    if (again.size() != read.size()) throw std::logic_error("reads back another number");
    for (std::size_t i = 0; i < read.size(); ++i) {
      if (again[i].components.size() != read[i].components.size() ||
          again[i].stamp_s != read[i].stamp_s || again[i].object != read[i].object)
        throw std::logic_error("reads back otherwise");
    }
  };
  const testing::FuzzReport report = testing::fuzz(originals, 10000, 31, parse);
  EXPECT_TRUE(report.failures.empty())
      << report.failures.size() << " failures, the first: " << report.failures[0];
  EXPECT_GT(report.accepted, 100U);
  EXPECT_GT(report.rejected, 100U);
}

TEST(DamagedObservation, Tables) { fuzz_observations(&parse_observations, &format_observations); }

TEST(DamagedObservation, Lines) {
  fuzz_observations(&parse_observation_lines, &format_observation_lines);
}

}  // namespace
}  // namespace posemix
