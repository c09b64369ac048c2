// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cstdlib>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "posemix/testing/data.hpp"
#include "run_program.hpp"

/// `posemix live` up to where it joins the graph; with it, python/tests/ros tests it.
namespace posemix {
namespace {

using testing::ProgramResult;
using testing::run_posemix;
using testing::TemporaryFolder;

TEST(LiveCommand, AWrongKeyIsNamedWithItsLine) {
  const TemporaryFolder folder;
  std::ofstream(folder / "live.toml") << "schema = 1\n[live]\nworld_frames = \"map\"\n";
  const ProgramResult result = run_posemix({"live", (folder / "live.toml").string()});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("live.toml:3"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("world_frame"), std::string::npos) << result.err;
}

TEST(LiveCommand, TheExampleIsReadAndTheDomainChecked) {
  setenv("ROS_DOMAIN_ID", "none", 1);
  const ProgramResult result =
      run_posemix({"live", POSEMIX_SOURCE_DIR "/examples/ros/live.toml", "--quiet"});
  unsetenv("ROS_DOMAIN_ID");
  EXPECT_EQ(result.exit_code, 3);
#ifdef POSEMIX_WITH_CYCLONE
  EXPECT_NE(result.err.find("ROS_DOMAIN_ID is \"none\", expected a number"), std::string::npos)
      << result.err;
#else
  EXPECT_NE(result.err.find("built without Cyclone DDS"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("cyclonedds-dev"), std::string::npos) << result.err;
#endif
}

}  // namespace
}  // namespace posemix
