// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cstdlib>

#include "io/expect_invalid.hpp"
#include "small_sequence.hpp"

namespace posemix {
namespace {

using testing::kSmallFrames;

class SequencePaths : public testing::SmallSequence {};

TEST_F(SequencePaths, FilesThatDoNotFitEachOther) {
  small_.folder.put("late.txt", "100 0 0 1 0 0 0 1\n");
  const std::string late = (small_.folder / "late.txt").string();
  EXPECT_INVALID_WITH(read_with({"objects.mug.detections.tum=late.txt"}),
                      late + ": got a detection at stamp 100 s, where " +
                          (small_.folder / "odometry.txt").string() + " has no frame");
  EXPECT_INVALID_WITH(read_with({"camera.ground_truth=late.txt"}),
                      late + ": no stamp fits a frame");
  EXPECT_INVALID_WITH(read_with({"objects.mug.ground_truth.relative_tum=late.txt"}), late);
  small_.folder.put("box/obj_000006_000021.npy",
                    testing::npy_bytes(Eigen::Matrix4d::Identity(), {}));
  EXPECT_INVALID_WITH(read_with({}), "box: got a detection 20 frames after the first, where ");
}

TEST_F(SequencePaths, ObjectTruth) {
  EXPECT_INVALID_WITH(read_with({"objects.box.ground_truth.entry=mug"}),
                      "is \"mug\", which is not in");
  EXPECT_INVALID_WITH(read_with({"objects.box.ground_truth.world_pose=[0,0,0,0,0,0,1]"}),
                      "has several of the keys relative_tum, pose_csv, world_tum, world_poses, "
                      "world_pose, bop_dataset, ycb_video, expected "
                      "one");
  EXPECT_INVALID_WITH(read_with({"objects.box.ground_truth={}"}), "has none of the keys");
  const SlamJob moving = read_with({"objects.mug.ground_truth={world_tum='truth/0001.txt'}"});
  EXPECT_TRUE(
      moving.sequence.objects[0].world_truth[4]->is_approx(small_.recording.camera[4], 1e-10));
  const SlamJob start = read_with({"objects.mug.start={rotation_sd_deg=4, translation_sd_m=0.1}"});
  EXPECT_NEAR((*start.models[0].independent_start)(4, 4), 0.01, 1e-15);
  EXPECT_FALSE(start.models[1].independent_start.has_value());
}

TEST_F(SequencePaths, ValuesThatAreTooExtreme) {
  small_.folder.put("far.txt", "0 1e200 0 0 0 0 0 1\n0.1 0 0 0 0 0 0 1\n");
  EXPECT_INVALID_WITH(read_with({"camera.odometry=far.txt"}),
                      "far.txt:1: got a position of 1e+200 m, expected metres, at most 1e+08");
  small_.folder.put("ns.txt", "1700000000000000000 0 0 0 0 0 0 1\n");
  EXPECT_INVALID_WITH(read_with({"camera.odometry=ns.txt"}),
                      "ns.txt:1: got stamp 1.7e+18, expected seconds");
}

TEST_F(SequencePaths, MissingFilesNameThePlacesLookedAt) {
  const std::string folder = small_.folder.path().string();
  EXPECT_INVALID(read_with({"camera.odometry=none.txt"}),
                 "--set camera.odometry=none.txt: key 'camera.odometry' names \"none.txt\", which "
                 "is not there; "
                 "looked for \"" +
                     folder + "/none.txt\"");
  EXPECT_INVALID_WITH(read_with({"camera.odometry=''"}), "is empty, expected the path of a file");
  const SlamJob absolute = read_with({"camera.odometry=" + folder + "/odometry.txt"});
  EXPECT_EQ(absolute.sequence.odometry.size(), kSmallFrames);
}

TEST_F(SequencePaths, RootsAreLookedThroughInOrder) {
  std::filesystem::create_directories(small_.folder / "deep/er");
  std::filesystem::rename(small_.folder / "odometry.txt", small_.folder / "deep/er/odometry.txt");
  const SlamJob job = read_with({"roots=['.', 'deep/er']"});
  EXPECT_EQ(job.sequence.odometry.size(), kSmallFrames);
  EXPECT_INVALID_WITH(read_with({"roots=['.', 'deep']"}), "deep/odometry.txt\"");
}

/// Sets an environment variable until the end of the scope.
class EnvironmentVariable {
 public:
  EnvironmentVariable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value, 1);
  }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;
  ~EnvironmentVariable() {
    if (before_) {
      setenv(name_, before_->c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(DataFolders, OrderOfPlaces) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(data_folders("a/b.toml", folder.path()),
            std::vector<std::filesystem::path>{folder.path()});
  EXPECT_INVALID_WITH(data_folders("a/b.toml", "/nowhere"), "/nowhere: is not a folder");
  EXPECT_EQ(data_folders("b.toml")[0], ".");
  {
    const EnvironmentVariable data("POSEMIX_DATA", "/data");
    EXPECT_EQ(data_folders("a/b.toml"), (std::vector<std::filesystem::path>{"a", "/data"}));
  }
  const EnvironmentVariable data("POSEMIX_DATA", "");
  const EnvironmentVariable cache("XDG_CACHE_HOME", "/cache");
  EXPECT_EQ(data_folders("a/b.toml"), (std::vector<std::filesystem::path>{"a", "/cache/posemix"}));
}

}  // namespace
}  // namespace posemix
