// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "io/expect_invalid.hpp"
#include "posemix/base/units.hpp"
#include "small_sequence.hpp"

namespace posemix {
namespace {

using testing::kSmallFrames;
using testing::kSmallToml;
using testing::replaced;

class SequenceCamera : public testing::SmallSequence {};

TEST_F(SequenceCamera, LeverArmMovesTheCameraTruthOnly) {
  const Eigen::Vector3d arm(0.02, 0.0, 0.001);
  const SlamJob plain = read_with({});
  const SlamJob moved = read_with({"camera.lever_arm_m=[0.02, 0.0, 0.001]"});
  const SE3d expected = *plain.sequence.camera_truth[5] * SE3d(SO3d(), arm);
  EXPECT_TRUE(moved.sequence.camera_truth[5]->is_approx(expected, 1e-14));
  EXPECT_TRUE(moved.camera_prior.mean().is_approx(*moved.sequence.camera_truth[0], 1e-14));
  EXPECT_TRUE(moved.sequence.odometry[5]->is_approx(*plain.sequence.odometry[5], 0.0));
  EXPECT_TRUE(moved.sequence.objects[1].world_truth[5]->is_approx(
      *plain.sequence.objects[1].world_truth[5], 0.0));
}

TEST_F(SequenceCamera, LeverArmBySequence) {
  const std::string ranges =
      "camera.lever_arms=[{from='0000', to='0059', lever_arm_m=[1,0,0]}, {from='0060', to='0091', "
      "lever_arm_m=[0,1,0]}]";
  const SlamJob plain = read_with({});
  const SlamJob first = read_with({ranges});
  EXPECT_TRUE(first.sequence.camera_truth[0]->is_approx(
      *plain.sequence.camera_truth[0] * SE3d(SO3d(), {1, 0, 0}), 1e-14));
  EXPECT_INVALID_WITH(read_with({ranges, "sequence=0099", "camera.ground_truth=truth/0001.txt"}),
                      "key 'camera.lever_arms' has no range that holds sequence '0099'");
  EXPECT_INVALID_WITH(read_with({ranges, "camera.lever_arm_m=[0,0,0]"}), "expected one of the two");
}

TEST_F(SequenceCamera, CameraStart) {
  const SlamJob identity = read_with({"camera.start.pose=identity"});
  EXPECT_TRUE(identity.camera_prior.mean().is_approx(SE3d(), 0.0));
  const SlamJob given = read_with({"camera.start.pose=[1, 2, 3, 0, 0, 1, 0]"});
  EXPECT_TRUE(
      given.camera_prior.mean().is_approx(SE3d(SO3d::exp({0, 0, radians(180)}), {1, 2, 3}), 1e-12));
  EXPECT_INVALID_WITH(read_with({"camera.start.pose=[1, 2, 3, 0, 0, 1, 1]"}),
                      "a quaternion of norm 1.41421");
  EXPECT_INVALID_WITH(
      read_changed("ground_truth = \"truth/${sequence}.txt\"", ""),
      "s.toml:9: key 'camera.start.pose' is \"ground_truth\", but camera.ground_truth has no pose");
}

TEST_F(SequenceCamera, StampsWithoutOdometry) {
  const std::string no_odometry =
      replaced(std::string(kSmallToml), "odometry = \"odometry.txt\"\n", "");
  const SlamJob truth = read(no_odometry);
  EXPECT_TRUE(truth.sequence.odometry.empty());
  EXPECT_EQ(truth.sequence.stamps.size(), kSmallFrames);
  EXPECT_EQ(truth.settings.motion.model, MotionModel::constant_velocity);
  EXPECT_INVALID_WITH(read(no_odometry, {"motion.model=odometry"}),
                      "there is no file under camera.odometry");

  const std::string no_camera = R"(schema = 1
[camera]
frame_period_s = 0.5
[noise.detector]
components = [{rotation_sd_deg = 3, translation_sd_m = 0.005}]
[[objects]]
id = "can"
noise = "detector"
detections = {bop = "can.csv", scene = 2, object = 5, min_score = 0.5}
)";
  const SlamJob numbers = read(no_camera);
  ASSERT_EQ(numbers.sequence.stamps.size(), kSmallFrames / 2);
  EXPECT_EQ(numbers.sequence.stamps[3], 3.0);
  EXPECT_TRUE(numbers.sequence.objects[0].detections[3].has_value());
  EXPECT_TRUE(numbers.sequence.camera_truth.empty());
  EXPECT_INVALID_WITH(read(no_camera, {"objects.can.detections.min_score=0.99"}),
                      "has no estimate of so high a score");
  EXPECT_INVALID_WITH(read(no_camera, {"objects.can.detections.first_frame=2"}), "has frame 1");

  const SlamJob stamped = read(no_camera, {"objects.0.detections={tum='mug.txt'}"});
  EXPECT_EQ(stamped.sequence.stamps.size(), kSmallFrames);
}

TEST_F(SequenceCamera, ImagesAreAllFramesOrThoseOfAFile) {
  EXPECT_TRUE(read_with({}).sequence.images.empty());
  const auto all = read_with({"camera.images=all"}).sequence.images;
  ASSERT_EQ(all.size(), kSmallFrames);
  EXPECT_EQ(all[3], std::vector<std::string>{""});
  const std::vector<double> stamps = read_with({}).sequence.stamps;
  small_.folder.put("images.txt", fmt::format("# stamps\n{}\n{}\n", stamps[0], stamps[2]));
  const auto some = read_with({"camera.images=images.txt"}).sequence.images;
  EXPECT_EQ(some[0].size(), 1U);
  EXPECT_TRUE(some[1].empty());
  EXPECT_EQ(some[2], std::vector<std::string>{""});

  small_.folder.put("late.txt", "1e6\n");
  EXPECT_INVALID_WITH(read_with({"camera.images=late.txt"}),
                      "late.txt:1: got an image at stamp 1000000 s, where");
  small_.folder.put("left.txt", fmt::format("{} left\n", stamps[0]));
  EXPECT_INVALID_WITH(read_with({"camera.images=left.txt"}),
                      "left.txt:1: got camera 'left', expected one of: ''");
  small_.folder.put("tags.txt", fmt::format("{} @tags\n{}\n", stamps[0], stamps[1]));
  const auto tags = read_with({"camera.images=tags.txt"}).sequence.images;
  EXPECT_EQ(tags[0], std::vector<std::string>{"@tags"});
  EXPECT_EQ(tags[1], std::vector<std::string>{""});
  small_.folder.put("left.txt", fmt::format("{} left@tags\n", stamps[0]));
  EXPECT_INVALID_WITH(read_with({"camera.images=left.txt"}),
                      "left.txt:1: got camera 'left@tags', expected one of: ''");
  small_.folder.put("words.txt", "all of them\n");
  EXPECT_INVALID_WITH(read_with({"camera.images=words.txt"}), "words.txt:1");
}

}  // namespace
}  // namespace posemix
