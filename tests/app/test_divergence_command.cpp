// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mixture_folder.hpp"

/// The command `posemix divergence`.
namespace posemix {
namespace {

using nlohmann::json;
using testing::contains;

class DivergenceCommand : public testing::MixtureFolder {};

TEST_F(DivergenceCommand, OfAFileFromItself) {
  for (const std::string distribution : {"", "-pg"}) {
    const std::string file = "mug" + distribution + ".json";
    const json found =
        json::parse(output_of("posemix divergence " + file + " " + file + " --json"));
    EXPECT_NEAR(found["kl"]["value"], 0.0, 1e-12);
    EXPECT_NEAR(found["isd"]["value"], 0.0, 1e-9);
    EXPECT_EQ(found["wasserstein"].is_null(), !distribution.empty());
    EXPECT_EQ(found.contains("wasserstein_reason"), !distribution.empty());
  }
  EXPECT_TRUE(contains(output_of("posemix divergence mug.json mug-pg.json"), "symmetric_kl:"));
  expect_error("posemix divergence mug.json", 2, "files");
}

TEST_F(DivergenceCommand, PrintsTheDigitsThatItsErrorLeaves) {
  output_of("posemix reduce mug.json --to 1 --out one.json --quiet");
  const std::string compared = "posemix divergence mug.json one.json";
  const json exact = json::parse(output_of(compared + " --json"))["kl"];
  const std::string table = output_of(compared);
  std::smatch found;
  const std::regex lines("kl:\n  value: +([0-9.]+)\n  standard_error: +0\\.0*([1-9][0-9]?)\n");
  ASSERT_TRUE(std::regex_search(table, found, lines)) << table;
  const double error = exact["standard_error"];
  EXPECT_NEAR(std::stod(found[1]), exact["value"].get<double>(), 0.051 * error);
  EXPECT_LT(found[1].length(), 10) << table;
}

// A component that turns by more than half a turn has a density that does not integrate to one.
TEST_F(DivergenceCommand, WarnsOfADivergenceBelowZero) {
  const auto about_z = [](double deviation_rad) {
    Matrix6d covariance = 1e-4 * Matrix6d::Identity();
    covariance(2, 2) = deviation_rad * deviation_rad;
    return MixtureFile{{"camera", "mug"},
                       ConcentratedPoses({{0.0, ConcentratedGaussian<SE3d>(SE3d(), covariance)}})};
  };
  put("wide.json", about_z(2.7));
  put("unknown.json", about_z(1.8));
  const std::string command = "posemix divergence wide.json unknown.json --json";
  const testing::ProgramResult result = shell(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(json::parse(result.out)["kl"]["value"], -0.1);
  EXPECT_TRUE(contains(result.err, "posemix: warning: kl is negative: the mixtures turn by more"))
      << result.err;
  EXPECT_EQ(shell("posemix divergence mug.json mug.json").err, "");
}

}  // namespace
}  // namespace posemix
