// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "run_program.hpp"

namespace posemix {
namespace {

using testing::contains;
using testing::ProgramResult;
using testing::run_posemix;

void expect_usage_error(const std::vector<std::string>& words, const std::string& part) {
  const ProgramResult result = run_posemix(words);
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_TRUE(contains(result.err, part)) << result.err;
  EXPECT_EQ(result.out, "");
}

/// Every option that takes an integer, with the command before it.
const std::vector<std::vector<std::string>> kIntegerOptions{{"fit", "--components"},
                                                            {"fit", "--max-components"},
                                                            {"fit", "--restarts"},
                                                            {"fit", "--max-iterations"},
                                                            {"fit", "--seed"},
                                                            {"reduce", "--to"},
                                                            {"reduce", "--drop"},
                                                            {"reduce", "--samples"},
                                                            {"reduce", "--seed"},
                                                            {"sample", "--count"},
                                                            {"sample", "--seed"},
                                                            {"divergence", "--samples"},
                                                            {"divergence", "--seed"},
                                                            {"convert", "--seed"},
                                                            {"grasp", "--starts"},
                                                            {"grasp", "--points"},
                                                            {"grasp", "--seed"},
                                                            {"consistency", "--object"},
                                                            {"fuse-views", "--groups"},
                                                            {"relocalise", "--least-objects"},
                                                            {"slam", "--smooth-lag"},
                                                            {"simulate", "--seed"},
                                                            {"data", "fetch", "--retries"},
                                                            {"data", "sequence", "--scene"},
                                                            {"data", "sequence", "--object"},
                                                            {"study", "divergence", "--threads"}};

TEST(Program, IntegersAreDecimalDigitsThatFit) {
  for (const std::vector<std::string>& option : kIntegerOptions) {
    for (const std::string value :
         {"0x10", "1.5", "1e3", "-1", "+1", "", " 1", "18446744073709551616"}) {
      std::vector<std::string> words = option;
      words.push_back(value);
      SCOPED_TRACE(fmt::format("{}", fmt::join(words, " ")));
      expect_usage_error(
          words, fmt::format("{}: got \"{}\", expected an integer from ", option.back(), value));
    }
  }
  expect_usage_error(
      {"fit", "--restarts", "10001"},
      "--restarts: got \"10001\", expected an integer from 1 to 10000 in decimal digits");
  EXPECT_TRUE(contains(run_posemix({"fit", "--help"}).out, "[1 - 10000]"));
}

}  // namespace
}  // namespace posemix
