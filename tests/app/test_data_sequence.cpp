// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/small_dataset.hpp"
#include "run_program.hpp"

/// `posemix data sequence` on a dataset's folder and a detector's results, then `posemix slam`.
namespace posemix {
namespace {

using nlohmann::json;
using testing::ProgramResult;
using testing::run_posemix;
using testing::SmallDataset;

class DataSequence : public ::testing::Test {
 protected:
  ProgramResult sequence(const std::string& dataset, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"data", "sequence",  small_.path(dataset),      "--scene",
                                       "2",    "--results", small_.path("results.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_posemix(arguments);
  }

  SmallDataset small_;
};

TEST_F(DataSequence, LeadsToFilteredPosesWithErrors) {
  for (const char* dataset : {"bop", "ycb"}) {
    const std::string toml = small_.path("scene.toml");
    const ProgramResult written = sequence(dataset, {"--out", toml});
    EXPECT_EQ(written.exit_code, 0) << written.err;
    EXPECT_NE(written.err.find("note: no symmetries are declared"), std::string::npos);
    const ProgramResult run =
        run_posemix({"slam", toml, "--json", "--out", small_.path(std::string("out_") + dataset)});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json metrics = json::parse(run.out);
    EXPECT_EQ(metrics["frames"], testing::kSmallFrames);
    for (const char* id : {"4", "5", "14"}) {
      EXPECT_EQ(metrics["objects"][id]["detections"], testing::kSmallFrames);
      EXPECT_LT(metrics["objects"][id]["relative_position_rmse_m"], 0.05) << dataset << id;
    }
  }
}

TEST_F(DataSequence, GoesThroughAPipeAndTellsMistakes) {
  const ProgramResult piped = sequence("bop", {"--object", "5", "--lever-arm", "0.02", "0", "0"});
  EXPECT_EQ(piped.exit_code, 0) << piped.err;
  EXPECT_NE(piped.out.find("lever_arm_m = [0.02, 0, 0]"), std::string::npos) << piped.out;
  EXPECT_EQ(piped.out.find("id = \"4\""), std::string::npos) << piped.out;
  const ProgramResult split = sequence("bop", {"--split", "train"});
  EXPECT_EQ(split.exit_code, 3);
  EXPECT_NE(split.err.find("bop/train/000002: is not there"), std::string::npos) << split.err;
  EXPECT_EQ(sequence("bop", {"--frame-period", "0"}).exit_code, 2);
  for (const auto& words : {std::vector<std::string>{"--min-score", ""},
                            {"--min-score", "nan"},
                            {"--lever-arm", "0.02", "", "0"}}) {
    const ProgramResult refused = sequence("bop", words);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find(words[0] + ": got "), std::string::npos) << refused.err;
  }
}

}  // namespace
}  // namespace posemix
