// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <gtest/gtest.h>

#include "posemix/slam/moving_objects.hpp"
#include "simulation_samples.hpp"

/// Frames that hold simulated objects, cameras that are still or on an arm, and what the filter is
/// told.
namespace posemix {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace)

TEST(SimulationFrames, AFrameHoldsAnObjectAndHandsItOver) {
  SimulationObject object = mug();
  object.held = {{"gripper", 2.0, 4.0}, {"hand", 4.0, 6.0}};
  SimulationConfig config = moving(object, 8.0);
  config.frames = {
      {"gripper", {{1.0, {{0, 0, 0.3}, {0, 0, 0}}}, {5.0, {{0.2, 0.1, 0.3}, {0.5, 0, 0}}}}},
      {"hand", {{3.0, {{0.4, 0, 0.2}, {0, 0, 0}}}, {7.0, {{0.4, 0.3, 0.1}, {0, 0, 1.5}}}}}};
  const SimulatedSequence simulated = simulate(config, 3);
  const auto grip = [&](std::size_t frame, double time_s) {
    const std::size_t k = frame_at(time_s);
    return simulated.frames[frame].truth[k].pose().inverse() *
           simulated.objects[0].world_at(k).pose();
  };
  for (const double time : {2.5, 3.0, 4.0})
    EXPECT_TRUE(grip(0, time).is_approx(grip(0, 2.0), 1e-7));
  for (const double time : {4.5, 5.0, 6.0})
    EXPECT_TRUE(grip(1, time).is_approx(grip(1, 4.0), 1e-7));
  EXPECT_FALSE(grip(0, 5.0).is_approx(grip(0, 2.0), 1e-3));
  const auto world = [&](double time_s) {
    return simulated.objects[0].world_at(frame_at(time_s)).pose();
  };
  EXPECT_TRUE(world(0.0).is_approx(world(2.0), 1e-8));
  EXPECT_TRUE(world(6.0).is_approx(world(7.9), 1e-8));
  // The frames stand at their waypoints.
  EXPECT_NEAR(
      (simulated.frames[0].truth.back().pose().translation() - Vector3d(0.2, 0.1, 0.3)).norm(), 0.0,
      1e-8);
}

TEST(SimulationFrames, PosesOfFramesAreToldWithTheirError) {
  SimulationConfig config = moving(mug(), 200.0);
  config.frames = {{"hand", {{0.0, {{3.0, 2.0, 1.0}, {0.3, 0.2, 1.0}}}}, small_sd()}};
  const SimulatedSequence simulated = simulate(config, 4);
  const SimulatedFrame& frame = simulated.frames[0];
  SampleMoments moments(6);
  for (std::size_t k = 0; k < frame.given.size(); ++k) {
    const SE3d truth = frame.truth[k].pose();
    const SE3d given = frame.given[k].pose();
    Vector6d error;
    error << (given.rotation() * truth.rotation().inverse()).log(),
        given.translation() - truth.translation();
    moments.add(error);
  }
  EXPECT_LT(moments.worst_score(Vector6d::Zero(), covariance_of(small_sd())), kBound);
  const FrameRecording recording = simulated.sequence().known_frames[0];
  EXPECT_EQ(recording.name, "hand");
  EXPECT_TRUE(recording.poses[7]->pose.is_approx(frame.given[7].pose(), 1e-12));
}

TEST(SimulationFrames, MotionOfOneObjectChangesNothingElse) {
  SimulationObject can = object_with({{1.0, small_sd()}}, "can");
  SimulationConfig config = moving(mug(), 4.0);
  config.objects.push_back(can);
  const SimulatedSequence still = simulate(config, 5);
  config.objects[0].hand_held = {{}};
  config.frames = {{"hand", {{0.0, {}}}}};
  const SimulatedSequence moved = simulate(config, 5);
  for (std::size_t k = 0; k < still.stamps_ns.size(); ++k) {
    EXPECT_EQ(still.objects[1].detections[k]->billionths,
              moved.objects[1].detections[k]->billionths);
    EXPECT_EQ(still.odometry[k].billionths, moved.odometry[k].billionths);
  }
  EXPECT_TRUE(still.objects[0].world_path.empty());
  EXPECT_FALSE(moved.objects[0].world_path.empty());
}

TEST(SimulationFrames, ACameraOnAnArmIsToldWithAnErrorOfItsOwnInEveryFrame) {
  SimulationConfig config = config_with({}, kManyFrames);
  config.path.set_up = SimulationSetUp::on_arm;
  config.path.arm = small_sd();
  const SimulatedSequence simulated = simulate(config, 6);
  SampleMoments moments(6);
  SampleMoments lagged(1);
  Vector6d before = Vector6d::Zero();
  for (std::size_t k = 0; k < kManyFrames; ++k) {
    const Vector6d error =
        (simulated.camera_truth[k].pose().inverse() * simulated.odometry[k].pose()).log();
    moments.add(error);
    lagged.add(Eigen::VectorXd::Constant(1, error[0] * before[0]));
    before = error;
  }
  EXPECT_LT(moments.worst_score(Vector6d::Zero(), covariance_of(small_sd())), kBound);
  EXPECT_NEAR(lagged.mean()[0] / covariance_of(small_sd())(0, 0), 0.0,
              kBound / std::sqrt(kManyFrames));
  EXPECT_EQ(motion_settings(config).model, MotionModel::given);
  EXPECT_TRUE(motion_settings(config).noise.covariance.isApprox(covariance_of(small_sd())));
  EXPECT_EQ(simulated.camera_start.billionths, simulated.odometry[0].billionths);
}

TEST(SimulationFrames, AStillCameraStaysWhereItsPathBegins) {
  SimulationConfig config = config_with({}, 100);
  const SE3d first = simulate(config, 7).camera_truth[0].pose();
  config.path.set_up = SimulationSetUp::still;
  const SimulatedSequence simulated = simulate(config, 7);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_TRUE(simulated.camera_truth[k].pose().is_approx(first, 0.0));
    EXPECT_TRUE(simulated.odometry[k].pose().is_approx(SE3d(), 0.0));
  }
  EXPECT_EQ(motion_settings(config).model, MotionModel::still);
}

TEST(SimulationFrames, TheModelsThatAreToldAreThoseOfTheMotions) {
  SimulationObject object = mug();
  EXPECT_TRUE(is_static(claimed_motion(moving(object, 10.0), object)));
  object.put_down = {{.moves = {.rate_per_s = 0.02, .area_m = {0.5, 0.5, 0.0}}}};
  const MotionModels put = claimed_motion(moving(object, 10.0), object);
  ASSERT_EQ(put.models.size(), 1U);
  EXPECT_EQ(std::get<PutDownMotion>(put.models[0]).jump_rate, 0.02);
  EXPECT_NEAR(std::get<PutDownMotion>(put.models[0]).volume_m3, 0.1, 1e-12);
  object.put_down.clear();
  object.hand_held = {{.start_s = 2.0, .stop_s = 6.0}};
  object.held = {{"hand", 6.0, 8.0}};
  SimulationConfig config = moving(object, 10.0);
  config.frames = {{"gripper", {{}}}, {"hand", {{}}}};
  const MotionModels held = claimed_motion(config, config.objects[0]);
  ASSERT_EQ(held.models.size(), 4U);
  EXPECT_EQ(std::get<AttachedMotion>(held.models[1]).frame, 1U);
  const auto& calm = std::get<ConstantVelocityMotion>(held.models[2]);
  const auto& agile = std::get<ConstantVelocityMotion>(held.models[3]);
  EXPECT_NEAR(calm.acceleration_sds[4], 0.4, 1e-12);
  EXPECT_NEAR(agile.acceleration_sds[4], 2.0, 1e-12);
  EXPECT_NEAR(held.rates(2, 3), 1.0, 1e-12);
  EXPECT_NEAR(held.rates(3, 2), 3.0, 1e-12);
  EXPECT_NO_THROW(validate(held));
  EXPECT_EQ(object_models(config)[0].motion.models.size(), 4U);
}

TEST(SimulationFrames, FalseDetectionsAreToldAsClutter) {
  SimulationConfig config = moving(mug(), 1.0);
  config.path.view = SimulationView{};
  config.objects.push_back(object_with({{1.0, small_sd()}}, "cup_1"));
  config.objects.push_back(object_with({{1.0, small_sd()}}, "cup_2"));
  config.objects[1].class_id = config.objects[2].class_id = "cup";
  config.clutter = {{.class_id = "cup",
                     .rate_per_image = 0.2,
                     .places = {{}, {}},
                     .runs = {.fraction = 0.1, .mean_run_s = 1.0}}};
  const std::vector<ObjectModel> models = object_models(config);
  EXPECT_EQ(models[0].noise.clutter().weight, 0.0);
  const double told = claimed_clutter_of(config, config.objects[1]).weight;
  EXPECT_NEAR(told, 0.2, 1e-12);
  EXPECT_NEAR(models[2].noise.clutter().weight, told / (1.0 + told), 1e-12);
}

TEST(SimulationFrames, SettingsThatDoNotFitAreRefused) {
  const auto message = [](const SimulationObject& object) -> std::string {
    try {
      SimulationConfig config = moving(object, 10.0);
      config.frames = {{"hand", {{}}}};
      simulate(config, 1);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  SimulationObject object = mug();
  object.held = {{"claw", 1.0, 2.0}};
  EXPECT_NE(message(object).find("held by 'claw', which is no frame"), std::string::npos);
  object.held = {{"hand", 3.0, 2.0}};
  EXPECT_NE(message(object).find("expected a later stop"), std::string::npos);
  object.held = {{"hand", 1.0, 5.0}};
  object.conveyor = {{.start_s = 4.0}};
  EXPECT_NE(message(object).find("motion 'conveyor' starts at 4 s, before motion 'held' stops"),
            std::string::npos);
  object = mug();
  object.put_down = {{}};
  EXPECT_NE(message(object).find("neither times nor a rate"), std::string::npos);
  object.put_down = {{.moves = {.times_s = {2.0, 1.0}}}};
  EXPECT_NE(message(object).find("time of a move"), std::string::npos);
  object = mug();
  object.appears_s = 4.0;
  object.removed_s = 3.0;
  EXPECT_NE(message(object).find("removed at 3 s"), std::string::npos);
}

}  // namespace
}  // namespace posemix
