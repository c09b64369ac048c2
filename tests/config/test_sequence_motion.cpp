// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Sequence files with objects that move, frames that hold them, and cameras of a known pose.
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/io/text.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/testing/expect.hpp"
#include "small_sequence.hpp"

namespace posemix {
namespace {

using testing::replaced;
using testing::thrown_message;

class SequenceMotion : public testing::SmallSequence {
 protected:
  /// The mug moves so, tracked by the multi-object filter.
  static std::string moving(const std::string& motion) {
    std::string text = replaced(std::string(testing::kSmallToml), "id = \"mug\"\n",
                                "id = \"mug\"\nmotion = " + motion + "\n");
    return text.substr(0, text.find("[filter]"));
  }
  MotionModels read_motion(const std::string& motion) {
    return read(moving(motion) + frames_).models[0].motion;
  }
  std::string message(const std::string& motion, const std::string& more = "") {
    return thrown_message([&] { read(moving(motion) + more); });
  }

  std::string frames_;
};

TEST_F(SequenceMotion, EveryModelIsRead) {
  EXPECT_TRUE(std::holds_alternative<StaticMotion>(read_motion("{model = \"static\"}").models[0]));
  const auto put_down = std::get<PutDownMotion>(
      read_motion("{model = \"put_down\", jump_rate = 0.1, volume_m3 = 2}").models[0]);
  EXPECT_EQ(put_down.jump_rate, 0.1);
  EXPECT_EQ(put_down.volume_m3, 2.0);
  const auto walk = std::get<RandomWalkMotion>(
      read_motion("{model = \"random_walk\", rotation_sd_deg = 10, translation_sd_m = [0.1, 0.2, "
                  "0.3], frame = \"world\", break_rate = 0}")
          .models[0]);
  EXPECT_NEAR(walk.sds[2], radians(10.0), 1e-15);
  EXPECT_EQ(walk.sds[4], 0.2);
  EXPECT_EQ(walk.frame, MotionFrame::world);
  EXPECT_EQ(walk.break_rate, 0.0);
  const auto constant = std::get<ConstantVelocityMotion>(
      read_motion("{model = \"constant_velocity\", acceleration_rotation_sd_deg = 20, "
                  "acceleration_translation_sd_m = 0.4, start_rotation_sd_deg = 90, "
                  "start_translation_sd_m = 1, frame = \"object\"}")
          .models[0]);
  EXPECT_NEAR(constant.acceleration_sds[0], radians(20.0), 1e-15);
  EXPECT_EQ(constant.acceleration_sds[3], 0.4);
  EXPECT_NEAR(constant.start_sds[1], radians(90.0), 1e-15);
  EXPECT_EQ(constant.start_sds[5], 1.0);
  // What is not stated is as in the library.
  const auto plain =
      std::get<ConstantVelocityMotion>(read_motion("{model = \"constant_velocity\"}").models[0]);
  EXPECT_EQ(plain.acceleration_sds, ConstantVelocityMotion().acceleration_sds);
  EXPECT_EQ(plain.break_rate, ConstantVelocityMotion().break_rate);
}

TEST_F(SequenceMotion, SeveralModelsChangeAtRates) {
  const MotionModels two = read_motion(
      "{models = [{model = \"static\"}, {model = \"constant_velocity\"}], "
      "rates = [[0, 0.2], [1, 0]], start = [0.9, 0.1]}");
  ASSERT_EQ(two.models.size(), 2U);
  EXPECT_EQ(two.rates(0, 1), 0.2);
  EXPECT_EQ(two.start[1], 0.1);
  const MotionModels named =
      read_motion("{model = \"calm_and_agile\", acceleration_translation_sd_m = 0.4}");
  ASSERT_EQ(named.models.size(), 2U);
  EXPECT_EQ(std::get<ConstantVelocityMotion>(named.models[1]).acceleration_sds[3], 2.0);
  EXPECT_EQ(named.rates, calm_and_agile().rates);
}

TEST_F(SequenceMotion, FramesHaveNamesAndPosesAtEveryStamp) {
  small_.folder.put("arm.tum",
                    "0.5 0 0 0 0 0 0 1\n"
                    "0.7 0.2 0 0 0 0 0 1\n");
  frames_ =
      "[[frames]]\nname = \"arm\"\nposes = \"arm.tum\"\nrotation_sd_deg = 1\n"
      "translation_sd_m = 0.002\n";
  const SlamJob job = read(
      moving("{model = \"attached\", frame = \"arm\", slip_translation_sd_m = 0.01}") + frames_);
  const auto attached = std::get<AttachedMotion>(job.models[0].motion.models[0]);
  EXPECT_EQ(attached.frame, 0U);
  EXPECT_EQ(attached.slip_sds[4], 0.01);
  ASSERT_EQ(job.sequence.known_frames.size(), 1U);
  const auto& poses = job.sequence.known_frames[0].poses;
  ASSERT_EQ(poses.size(), job.sequence.stamps.size());
  EXPECT_EQ(poses[0]->pose.translation().x(), 0.0);  // as at first
  EXPECT_NEAR(poses[6]->pose.translation().x(), 0.1, 1e-12);
  EXPECT_FALSE(poses[9]);
  EXPECT_NEAR(poses[6]->covariance(5, 5), 4e-6 + std::pow(0.1 * radians(1.0), 2), 1e-12);
  EXPECT_EQ(std::get<MultiObjectSlamSettings>(job.settings.tracker).frames,
            std::vector<std::string>{"arm"});
  EXPECT_EQ(run(job).frames.size(), job.sequence.stamps.size());
}

TEST_F(SequenceMotion, AMovingObjectIsTrackedAndScored) {
  // The true pose of the mug in the world at every stamp.
  std::vector<StampedPose> truth;
  std::vector<StampedPose> seen;
  for (std::size_t k = 0; k < testing::kSmallFrames; ++k) {
    const double stamp = small_.recording.stamps[k];
    const SE3d mug = SE3d(SO3d(), {0.1 * stamp, 0.0, 0.0}) * small_.recording.objects[0];
    truth.push_back({stamp, mug});
    seen.push_back({stamp, small_.recording.camera[k].inverse() * mug});
  }
  small_.folder.put("mug_world.txt", format_tum(truth));
  small_.folder.put("mug.txt", format_tum(seen));
  const SlamJob job =
      read(replaced(moving("{model = \"constant_velocity\"}"), "relative_tum = \"mug_truth.txt\"",
                    "world_tum = \"mug_world.txt\""));
  const SlamRun result = run(job);
  const Metrics metrics = evaluate(job, result);
  EXPECT_LT(*metrics.objects[0].world.position_rmse_m, 0.01);
  EXPECT_LT(*metrics.objects[0].relative.position_rmse_m, 0.01);
  EXPECT_NEAR(result.frames.back().object("mug").twist->mean[3], 0.1, 0.03);
  EXPECT_FALSE(result.pose_indices[0]);
  EXPECT_FALSE(result.hypotheses[0].empty());
}

TEST_F(SequenceMotion, ACameraMayBeStill) {
  SlamJob job = read_changed("noise = {per", "model = \"still\"\nnoise = {per");
  EXPECT_EQ(job.settings.motion.model, MotionModel::still);
}

TEST_F(SequenceMotion, TheFilterOfMovingObjectsHasSettings) {
  const SlamJob job = read(moving("{model = \"random_walk\"}") +
                           "[filter.moving]\nlost_rate = 0.01\nmax_hypotheses = 3\n");
  const auto& settings = std::get<MultiObjectSlamSettings>(job.settings.tracker).moving;
  EXPECT_EQ(settings.lost_rate, 0.01);
  EXPECT_EQ(settings.max_hypotheses, 3U);
  EXPECT_EQ(settings.turned_clutter, MovingObjectSettings().turned_clutter);
}

TEST_F(SequenceMotion, TheCameraMayBeGiven) {
  const std::string text = replaced(moving("{model = \"constant_velocity\"}"), "noise = {per",
                                    "model = \"given\"\nnoise = {per");
  small_.folder.put("odometry.txt", read_file(small_.folder.path() / "truth/0001.txt"));
  const SlamJob job = read(text);
  const Metrics metrics = evaluate(job, run(job));
  EXPECT_LT(*metrics.camera.position_rmse_m, 0.005);
  EXPECT_NE(thrown_message([&] {
              read(replaced(text, "odometry = \"odometry.txt\"\n", ""));
            }).find("is \"given\", but there is no file under camera.odometry"),
            std::string::npos);
}

TEST_F(SequenceMotion, RefusesWhatIsWrong) {
  const auto expect = [&](const std::string& motion, const std::string& part,
                          const std::string& more = "") {
    EXPECT_NE(message(motion, more).find(part), std::string::npos) << message(motion, more);
  };
  expect("{model = \"flying\"}",
         "key 'objects[0].motion.model' is the string \"flying\", expected");
  expect("{model = \"static\", jump_rate = 1}", "jump_rate");
  expect("{model = \"random_walk\", rotation_sd_rad = 1}", "expected 'rotation_sd_deg'");
  expect("{model = \"random_walk\", break_rate = -1}", "expected a number in [0");
  expect("{model = \"attached\", frame = \"arm\"}", "no table [[frames]] has that name");
  expect("{models = [{model = \"static\"}, {model = \"put_down\"}], rates = [[0, -1], [0, 0]]}",
         "the rate from model 0 to 1");
  expect("{models = [{model = \"static\"}, {model = \"put_down\"}], start = [0.5, 0.6]}",
         "sum to 1.1");
  expect("{model = \"static\", models = [{model = \"static\"}]}", "stands beside 'models'");
  expect("{models = [{model = \"calm_and_agile\"}]}",
         "is the string \"calm_and_agile\", expected one of");
  expect("{model = \"constant_velocity\"}", "is for filter.method = \"multi_object\"",
         "[filter]\nmethod = \"gm-iekf\"\n");
  expect("{model = \"constant_velocity\"}", "is for filter.smooth = \"none\" or \"full\"",
         "[filter]\nmethod = \"fixed_lag\"\n");
  EXPECT_NE(thrown_message([&] {
              read(replaced(moving("{model = \"random_walk\"}"), "id = \"mug\"\n",
                            "id = \"mug\"\nprior = {pose = [0, 0, 0, 0, 0, 0, 1], "
                            "rotation_sd_deg = 1, translation_sd_m = 0.1}\n"));
            }).find("'mug': it moves and has a prior"),
            std::string::npos);
  const std::string frame = "[[frames]]\nname = \"arm\"\nposes = \"mug.txt\"\n";
  expect("{model = \"static\"}", "which another frame has already", frame + frame);
}

}  // namespace
}  // namespace posemix
