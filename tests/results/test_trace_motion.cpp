// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <string>

#include <nlohmann/json.hpp>

#include "config/small_recording.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/results/results.hpp"
#include "posemix/results/trace_tracks.hpp"

/// What the files of a run say of an object that moves.
namespace posemix {
namespace {

TEST(TraceMotion, AnObjectThatMovesHasModelsAndTwist) {
  const testing::SmallFolder small;
  std::string text(testing::kSmallToml);
  text = testing::replaced(text.substr(0, text.find("[filter]")), "id = \"mug\"\n",
                           "id = \"mug\"\nmotion = {model = \"calm_and_agile\"}\n");
  const SlamJob job = read_slam_job(TomlDocument::parse(text, "s.toml"), {small.folder.path()});
  const SlamRun result = run(job, {.record_hypotheses = true, .progress = {}});
  nlohmann::json trace;
  nlohmann::json posterior;
  bool has_mixture = false;
  for (const auto& [name, file] : format_results(job, result, evaluate(job, result))) {
    if (name == "trace.json") {
      trace = nlohmann::json::parse(file);
      small.folder.put("trace.json", file);
    }
    if (name == "posterior.json") posterior = nlohmann::json::parse(file);
    has_mixture = has_mixture || name == "mixture_mug.json";
  }
  EXPECT_TRUE(has_mixture);
  const auto& mug = trace.at("objects").at("mug");
  EXPECT_EQ(mug.at("model_names"),
            nlohmann::json::array({"constant_velocity", "constant_velocity"}));
  ASSERT_EQ(mug.at("models").size(), job.sequence.stamps.size());
  EXPECT_NEAR(mug.at("models")[5][0].get<double>() + mug.at("models")[5][1].get<double>(), 1.0,
              1e-6);
  EXPECT_EQ(mug.at("twist")[5].size(), 6U);
  EXPECT_GT(mug.at("twist_sd")[5][0].get<double>(), 0.0);
  EXPECT_FALSE(mug.at("alternatives")[5].empty());
  // Objects that stand still have none of it.
  EXPECT_FALSE(trace.at("objects").at("box").contains("models"));
  // The joint posterior is that of the camera and of the two objects that stand still.
  EXPECT_EQ(posterior.at("poses").size(), 3U);
  EXPECT_EQ(read_trace_tracks(small.folder.path() / "trace.json").size(), 7U);
}

}  // namespace
}  // namespace posemix
