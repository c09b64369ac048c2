// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/state_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "io/temporary_folder.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/testing/data.hpp"
#include "posemix/testing/expect.hpp"
#include "slam/state_scene.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

using testing::RichScene;

class StateFile : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
};

TEST_F(StateFile, HoldsTheStateAndReplacesAnOlderOne) {
  const fs::path path = folder_ / "map.state";
  StampedSlam slam = RichScene::slam();
  save_state(path, slam);
  for (const auto& input : RichScene(4).session(1.0)) testing::give(slam, input);
  slam.estimate();
  save_state(path, slam);
  EXPECT_EQ(testing::content_of(path), state_bytes(slam));
  EXPECT_EQ(state_bytes(std::get<StampedSlam>(load_state(path))), state_bytes(slam));
  save_state(path, slam.slam());
  EXPECT_EQ(state_bytes(std::get<MultiObjectSlam>(load_state(path))), state_bytes(slam.slam()));
  // Nothing else is left in the folder.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

TEST_F(StateFile, ErrorsNameTheFile) {
  const fs::path path = folder_ / "map.state";
  EXPECT_TRUE(testing::thrown_message([&] { load_state(path); }).starts_with(path.string()));
  std::ofstream(path) << "not a state";
  EXPECT_EQ(testing::thrown_message([&] { load_state(path); }),
            path.string() +
                ": this is not a saved state of posemix, expected one (posemix::state_bytes)");
  EXPECT_THROW(save_state(folder_ / "none" / "map.state", RichScene::slam()), OutputError);
}

}  // namespace
}  // namespace posemix
