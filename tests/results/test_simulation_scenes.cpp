// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/results/simulation_folder.hpp"
#include "simulated_job.hpp"

/// Simulations in which objects move, come and go, as files.
namespace posemix {
namespace {

using testing::expect_same_poses;
using testing::job_from;

constexpr std::string_view kScene = R"(schema = 1
[camera]
frames = 60
set_up = "still"
view = {width_px = 320, height_px = 240, focal_length_px = 250, least_range_m = 0.3, largest_range_m = 3}
[noise.n]
components = [{rotation_sd_deg = 2, translation_sd_m = 0.01}]
[[objects]]
id = "mug"
noise = "n"
appears_s = 0.5
removed_s = 5
[[objects.conveyor]]
velocity_m_s = [0.02, 0, 0]
turn_deg_s = [0, 0, 10]
stop_s = 1
[[objects.hand_held]]
start_s = 1
stop_s = 2
reach_m = 0.1
reach_deg = 40
acceleration_rotation_sd_deg = 20
acceleration_translation_sd_m = [0.1, 0.2, 0.3]
agile_factor = 3
calm_s = 2
agile_s = 0.5
ramp_s = 0.2
[[objects.held]]
frame = "hand"
start_s = 2
stop_s = 3
[[objects]]
id = "cup_1"
class = "cup"
noise = "n"
position_m = [0.1, 0.2, 0]
[[objects.pick_and_place]]
times_s = [1, 3.5]
places = [{position_m = [0.1, 0, 0], rotation_deg = [0, 0, 90]}]
duration_s = 1.5
lift_m = 0.2
[[objects]]
id = "cup_2"
class = "cup"
noise = "n"
position_m = [-0.2, 0.1, 0]
[[objects.put_down]]
rate_per_s = 0.5
area_m = [0.1, 0.1, 0]
hidden_s = 0.3
[[frames]]
name = "hand"
rotation_sd_deg = 0.5
translation_sd_m = 0.002
waypoints = [{time_s = 1, position_m = [0, 0, 0.1]}, {time_s = 3, position_m = [0.1, 0, 0.1], rotation_deg = [0, 0, 30]}]
[[clutter]]
class = "cup"
rate_per_image = 0.3
places = [{position_m = [0, 0.1, 0]}]
fraction = 0.3
mean_run_s = 0.5
rotation_sd_deg = 10
translation_sd_m = 0.02
)";

SimulationFile scene_from(std::string_view text) {
  return read_simulation(TomlDocument::parse(text, "sim.toml"));
}

/// The scene with a part replaced.
std::string scene_with(const std::string& from, const std::string& to) {
  std::string text(kScene);
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(SimulationScenes, EveryKeyIsRead) {
  const SimulationConfig config = scene_from(kScene).config;
  EXPECT_EQ(config.path.set_up, SimulationSetUp::still);
  ASSERT_TRUE(config.path.view.has_value());
  EXPECT_EQ(config.path.view->width_px, 320);
  EXPECT_EQ(config.path.view->largest_range_m, 3.0);
  const SimulationObject& mug = config.objects[0];
  EXPECT_EQ(mug.appears_s, 0.5);
  EXPECT_EQ(mug.removed_s, 5.0);
  EXPECT_EQ(mug.conveyor[0].velocity_m_s.x(), 0.02);
  EXPECT_NEAR(mug.conveyor[0].turn_rad_s.z(), radians(10.0), 1e-15);
  const SimulationHandHeld& hand = mug.hand_held[0];
  EXPECT_EQ(hand.reach_m, Eigen::Vector3d::Constant(0.1));
  EXPECT_NEAR(hand.reach_rad, radians(40.0), 1e-15);
  EXPECT_NEAR(hand.acceleration.rotation_rad.y(), radians(20.0), 1e-15);
  EXPECT_EQ(hand.acceleration.translation_m, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(hand.agile_factor, 3.0);
  EXPECT_EQ(hand.calm_s, 2.0);
  EXPECT_EQ(hand.agile_s, 0.5);
  EXPECT_EQ(hand.ramp_s, 0.2);
  EXPECT_EQ(mug.held[0].frame, "hand");
  const SimulationPickAndPlace& carried = config.objects[1].pick_and_place[0];
  EXPECT_EQ(config.objects[1].class_id, "cup");
  EXPECT_EQ(carried.moves.times_s, (std::vector<double>{1.0, 3.5}));
  EXPECT_NEAR(carried.moves.places[0].rotation_rad.z(), radians(90.0), 1e-15);
  EXPECT_EQ(carried.duration_s, 1.5);
  EXPECT_EQ(carried.lift_m, 0.2);
  const SimulationPutDown& put = config.objects[2].put_down[0];
  EXPECT_EQ(put.moves.rate_per_s, 0.5);
  EXPECT_EQ(put.moves.area_m, Eigen::Vector3d(0.1, 0.1, 0.0));
  EXPECT_EQ(put.hidden_s, 0.3);
  EXPECT_EQ(config.frames[0].waypoints[1].time_s, 3.0);
  EXPECT_EQ(config.frames[0].error.translation_m.x(), 0.002);
  EXPECT_EQ(config.clutter[0].rate_per_image, 0.3);
  EXPECT_EQ(config.clutter[0].runs.mean_run_s, 0.5);
  EXPECT_EQ(config.clutter[0].sd.translation_m.x(), 0.02);
}

TEST(SimulationScenes, ReadBackAsTheyWereSimulated) {
  const SimulationFile file = scene_from(kScene);
  const SimulatedSequence simulated = simulate(file.config, 3);
  const auto files = format_simulation(file, simulated, 3);
  EXPECT_EQ(files, format_simulation(file, simulate(file.config, 3), 3));
  const SlamJob job = job_from(files);
  const Sequence expected = simulated.sequence();
  EXPECT_EQ(job.sequence.stamps, expected.stamps);
  // Of the class with false detections, four more instances.
  ASSERT_EQ(job.sequence.objects.size(), 7U);
  EXPECT_EQ(job.sequence.objects[6].id, "cup_spare_4");
  for (std::size_t i = 0; i < 3; ++i) {
    const ObjectRecording& object = job.sequence.objects[i];
    expect_same_poses(object.detections, expected.objects[i].detections, object.id);
    expect_same_poses(object.world_truth, expected.objects[i].world_truth, object.id + " truth");
  }
  ASSERT_EQ(job.sequence.observations.size(), 60U);
  for (std::size_t k = 0; k < 60; ++k) {
    ASSERT_EQ(job.sequence.observations[k].size(), expected.observations[k].size()) << k;
    for (std::size_t i = 0; i < expected.observations[k].size(); ++i) {
      const Observation& actual = job.sequence.observations[k][i];
      const Observation& wanted = expected.observations[k][i];
      EXPECT_EQ(actual.object, wanted.object);
      EXPECT_EQ(actual.class_id, wanted.class_id);
      EXPECT_TRUE(actual.components[0].pose.is_approx(wanted.components[0].pose, 1e-9));
    }
  }
  ASSERT_EQ(job.sequence.known_frames.size(), 1U);
  for (std::size_t k = 0; k < 60; ++k) {
    const auto& actual = job.sequence.known_frames[0].poses[k];
    const auto& wanted = expected.known_frames[0].poses[k];
    EXPECT_TRUE(actual->pose.is_approx(wanted->pose, 1e-9));
    EXPECT_TRUE(actual->covariance.isApprox(wanted->covariance, 1e-6));
  }
}

TEST(SimulationScenes, TheFilterIsToldHowObjectsMove) {
  const SimulationFile file = scene_from(kScene);
  const SimulatedSequence simulated = simulate(file.config, 3);
  const SlamJob job = job_from(format_simulation(file, simulated, 3));
  EXPECT_EQ(job.settings.motion.model, MotionModel::still);
  const std::vector<ObjectModel> expected = object_models(file.config);
  for (std::size_t i = 0; i < 3; ++i) {
    const MotionModels& actual = job.models[i].motion;
    const MotionModels& wanted = expected[i].motion;
    ASSERT_EQ(actual.models.size(), wanted.models.size()) << i;
    EXPECT_TRUE(actual.rates.isApprox(wanted.rates, 1e-8)) << i;
    // Of the mug there are no false detections, for which the reader assumes a default.
    if (i > 0) {
      EXPECT_NEAR(job.models[i].noise.clutter().weight, expected[i].noise.clutter().weight, 1e-9);
    }
    for (std::size_t m = 0; m < actual.models.size(); ++m) {
      ASSERT_EQ(actual.models[m].index(), wanted.models[m].index());
      const auto* twist = std::get_if<ConstantVelocityMotion>(&actual.models[m]);
      if (twist == nullptr) continue;
      const auto& same = std::get<ConstantVelocityMotion>(wanted.models[m]);
      EXPECT_TRUE(twist->acceleration_sds.isApprox(same.acceleration_sds, 1e-6));
      EXPECT_TRUE(twist->start_sds.isApprox(same.start_sds, 1e-6));
      EXPECT_EQ(twist->frame, same.frame);
    }
  }
  // Both cups are told alike.
  EXPECT_EQ(job.models[1].motion.models.size(), job.models[2].motion.models.size());
}

TEST(SimulationScenes, AllTruthIsWritten) {
  const SimulationFile file = scene_from(kScene);
  const auto files = format_simulation(file, simulate(file.config, 3), 3);
  for (const char* name :
       {"world_truth_mug.tum", "truth_mug.tum", "world_truth_cup_1.tum", "world_truth_cup_2.tum",
        "frame_hand.tum", "frame_truth_hand.tum", "observations.csv", "sources.csv"})
    EXPECT_TRUE(files.contains(name)) << name;
  EXPECT_FALSE(files.contains("detections_mug.tum"));
  // Of the times at which it is there, 0.5 to 5 s, and a line of comment.
  const std::string& truth = files.at("world_truth_mug.tum");
  EXPECT_EQ(std::count(truth.begin(), truth.end(), '\n'), 46);
  const auto lines = [&](const char* name) {
    return std::count(files.at(name).begin(), files.at(name).end(), '\n');
  };
  EXPECT_EQ(lines("observations.csv"), lines("sources.csv"));
  EXPECT_NE(files.at("sources.csv").find(",cup_2\n"), std::string::npos);
  EXPECT_NE(files.at("sources.csv").find(",\n"), std::string::npos);
}

TEST(SimulationScenes, ErrorsNameFileLineAndKey) {
  const auto expect = [](const std::string& from, const std::string& to, const std::string& part) {
    const std::string text =
        testing::invalid_input_message([&] { scene_from(scene_with(from, to)); });
    EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks: " << part;
  };
  expect("set_up = \"still\"", "set_up = \"fixed\"", "sim.toml:4: key 'camera.set_up'");
  expect("width_px = 320", "width = 320", "sim.toml:5: ");
  expect("velocity_m_s", "velocity", "sim.toml:14: ");
  expect("times_s = [1, 3.5]", "times_s = []",
         "sim.toml:38: key 'objects[1].pick_and_place[0].times_s'");
  expect("rate_per_s = 0.5", "rate_per_s = 0",
         "sim.toml:48: key 'objects[2].put_down[0].rate_per_s'");
  expect("rate_per_s = 0.5", "lift_m = 1", "times_s' is expected, or rate_per_s");
  expect("frame = \"hand\"", "frame = \"claw\"", "object 'mug': it is held by 'claw'");
  expect("stop_s = 2\nreach_m", "stop_s = 2.5\nreach_m", "motion 'held' starts at 2 s");
  expect("name = \"hand\"", "name = \"a b\"", "sim.toml:52: key 'frames[0].name'");
  expect("rate_per_image = 0.3", "rate_per_image = -1",
         "sim.toml:58: key 'clutter[0].rate_per_image'");
  expect("class = \"cup\"\nrate", "class = \"can\"\nrate", "no object has that class");
}

}  // namespace
}  // namespace posemix
