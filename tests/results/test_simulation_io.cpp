// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/results/simulation_folder.hpp"
#include "posemix/testing/expect.hpp"
#include "simulated_job.hpp"

namespace posemix {
namespace {

using testing::expect_same_poses;
using testing::job_from;

constexpr std::string_view kConfig = R"(schema = 1

[camera]
frames = 40
period_s = 0.04
turns = 1
target_m = [0.1, 0.0, 0.05]
range = {mean_m = 0.9, swing_m = 0.2, waves = 2}
height = {mean_m = 0.3, swing_m = 0.1, waves = 1}
[camera.start]
rotation_sd_deg = [0.1, 0.2, 0.3]
translation_sd_m = 0.004
[odometry]
rotation_sd_deg = 0.2
translation_sd_m = [0.002, 0.003, 0.004]

[noise.mug]
components = [
  {weight = 3, rotation_sd_deg = [3, 3, 4], translation_sd_m = 0.006},
  {weight = 1, frame = "camera", rotation_sd_deg = [3, 3, 25], translation_sd_m = 0.006},
]
[noise.plain]
components = [{rotation_sd_deg = 2, translation_sd_m = 0.01}]

[[objects]]
id = "mug"
noise = "mug"
position_m = [0.2, 0.1, 0.05]
rotation_deg = [0, 0, 40]
correlation_s = 0.1
flips = {fraction = 0.2, mean_run_s = 0.2, rotation_deg = [0, 0, 180], translation_m = [0.01, 0, 0]}
outliers = {fraction = 0.1, mean_run_s = 0.2, box_m = [0.1, 0.2, 0.3]}
misses = {fraction = 0.2}

[[objects]]
id = "box.2"
noise = "plain"
claimed_noise = "mug"
hidden_frames = 15

[filter]
method = "gm-iekf"
gate_probability = 0.99
max_components = 7
pair_rule = "runnalls"
)";

SimulationFile config_from(std::string_view text, const std::vector<std::string>& overrides = {}) {
  TomlDocument document = TomlDocument::parse(text, "sim.toml");
  for (const std::string& assignment : overrides) document.apply_override(assignment);
  return read_simulation(document);
}

/// The configuration with a line replaced.
std::string with(const std::string& from, const std::string& to) {
  std::string text(kConfig);
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// FNV-1a with 64 bits.
std::uint64_t hash_of(const std::map<std::string, std::string>& files) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto add = [&](std::string_view text) {
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  };
  for (const auto& [name, content] : files) {
    add(name);
    add(content);
  }
  return hash;
}

TEST(SimulationFolder, SameBytesEverywhere) {
  const SimulationFile file = config_from(kConfig);
  const auto files = format_simulation(file, simulate(file.config, 42), 42);
  EXPECT_EQ(hash_of(files), 16484890814191428266U) << files.at("detections_mug.tum");
  EXPECT_NE(hash_of(files), hash_of(format_simulation(file, simulate(file.config, 43), 42)));
}

TEST(SimulationFolder, ReadsBackAsItWasSimulated) {
  const SimulationFile file = config_from(kConfig);
  const SimulatedSequence simulated = simulate(file.config, 7);
  const SlamJob job = job_from(format_simulation(file, simulated, 7));
  const Sequence expected = simulated.sequence();
  EXPECT_EQ(job.sequence.stamps, expected.stamps);
  EXPECT_EQ(job.sequence.images, expected.images);
  expect_same_poses(job.sequence.odometry, expected.odometry, "odometry");
  expect_same_poses(job.sequence.camera_truth, expected.camera_truth, "camera truth");
  ASSERT_EQ(job.sequence.objects.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const ObjectRecording& object = job.sequence.objects[i];
    EXPECT_EQ(object.id, expected.objects[i].id);
    expect_same_poses(object.detections, expected.objects[i].detections, object.id);
    expect_same_poses(object.world_truth, expected.objects[i].world_truth, object.id + " truth");
  }
}

TEST(SimulationFolder, SequenceFileTellsTheFilterWhatTheConfigurationSays) {
  const SimulationFile file = config_from(kConfig);
  const SimulatedSequence simulated = simulate(file.config, 7);
  const SlamJob job = job_from(format_simulation(file, simulated, 7));
  const ConcentratedGaussian<SE3d> prior = camera_prior(file.config, simulated);
  EXPECT_TRUE(job.camera_prior.mean().is_approx(prior.mean(), 1e-9));
  EXPECT_TRUE(job.camera_prior.covariance().isApprox(prior.covariance(), 1e-9));
  EXPECT_EQ(job.settings.motion.model, MotionModel::odometry);
  EXPECT_EQ(job.settings.motion.noise.per, NoisePer::second);
  EXPECT_TRUE(job.settings.motion.noise.covariance.isApprox(
      motion_settings(file.config).noise.covariance, 1e-9));
  const auto& filter = std::get<GaussianSumSettings>(job.settings.tracker);
  EXPECT_EQ(filter.gate_probability, 0.99);
  EXPECT_EQ(filter.reduction.max_components, 7U);
  EXPECT_EQ(filter.reduction.pair, PairRule::runnalls);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& actual = job.models[i].noise.components();
    const ObjectModel model = object_model(file.config.objects[i]);
    const auto& expected = model.noise.components();
    ASSERT_EQ(actual.size(), expected.size());
    ASSERT_EQ(actual.size(), i == 0 ? 4U : 2U);
    for (std::size_t c = 0; c < actual.size(); ++c) {
      EXPECT_NEAR(actual[c].weight, expected[c].weight, 1e-9);
      EXPECT_EQ(actual[c].frame, expected[c].frame);
      EXPECT_TRUE(actual[c].covariance.isApprox(expected[c].covariance, 1e-8));
      EXPECT_TRUE(actual[c].offset.is_approx(expected[c].offset, 1e-9));
    }
  }
}

TEST(SimulationFolder, RelativeTruthAndMissesAreWritten) {
  const SimulationFile file = config_from(kConfig);
  const auto files = format_simulation(file, simulate(file.config, 7), 7);
  ASSERT_EQ(files.size(), 7U);
  const std::string& truth = files.at("truth_box.2.tum");
  EXPECT_EQ(std::count(truth.begin(), truth.end(), '\n'), 41);
  const std::string& detections = files.at("detections_box.2.tum");
  EXPECT_NE(detections.find("\n0 0 0 0 0 0 0 0\n0.04 0 0 0 0 0 0 0\n"), std::string::npos);
  EXPECT_EQ(detections.find("\n0.6 0 "), std::string::npos);
}

TEST(SimulationConfig, DefaultsAreThoseOfTheStructs) {
  const SimulationFile file = config_from(
      "schema = 1\n[[objects]]\nid = \"a\"\nnoise = \"n\"\n[noise.n]\ncomponents = [{}]\n");
  const SimulationConfig& config = file.config;
  EXPECT_EQ(config.path.frames, SimulationPath{}.frames);
  EXPECT_EQ(config.odometry.rotation_rad, SimulationConfig{}.odometry.rotation_rad);
  EXPECT_EQ(config.objects[0].noise[0].sd.translation_m, SimulationNoise{}.sd.translation_m);
  EXPECT_FALSE(config.claimed_odometry.has_value());
  EXPECT_TRUE(file.filter.empty());
  EXPECT_EQ(job_from(format_simulation(file, simulate(config, 1), 1)).sequence.stamps.size(), 600U);
}

TEST(SimulationConfig, NoiseAlongTheViewingRayIsSimulatedAndTold) {
  const std::string begin =
      "schema = 1\n[camera]\nframes = 20\n[[objects]]\nid = \"a\"\nnoise = \"n\"\n[noise.n]\n"
      "components = [{frame = \"ray\", rotation_sd_deg = [7, 7, 2], ";
  const SimulationFile file =
      config_from(begin + "translation_sd_of_range = [0.007, 0.007, 0.045]}]\n");
  const SimulationNoise& noise = file.config.objects[0].noise[0];
  EXPECT_EQ(noise.frame, NoiseFrame::ray);
  EXPECT_EQ(noise.sd.translation_m, Eigen::Vector3d(0.007, 0.007, 0.045));
  const SlamJob job = job_from(format_simulation(file, simulate(file.config, 1), 1));
  const NoiseComponent& told = job.models[0].noise.components()[0];
  EXPECT_EQ(told.frame, NoiseFrame::ray);
  EXPECT_NEAR(told.covariance(5, 5), 0.045 * 0.045, 1e-12);
  EXPECT_NE(testing::thrown_message([&] {
              config_from(begin + "translation_sd_m = 0.01}]\n");
            }).find("translation_sd_m"),
            std::string::npos);
}

TEST(SimulationConfig, MotionIsWhatTheFilterIsTold) {
  const std::string text =
      with("[noise.mug]",
           "[motion]\nnoise = {rotation_sd_deg = 1, translation_sd_m = 0.1}\n[noise.mug]");
  const SimulationFile file = config_from(text);
  EXPECT_EQ(file.config.claimed_odometry->translation_m, Eigen::Vector3d::Constant(0.1));
  const SlamJob job = job_from(format_simulation(file, simulate(file.config, 1), 1));
  EXPECT_NEAR(job.settings.motion.noise.covariance(5, 5), 0.01, 1e-12);
}

TEST(SimulationConfig, OverridesReachTheSequenceFile) {
  const SimulationFile file =
      config_from(kConfig, {"camera.frames=20", "objects.mug.misses.fraction=0",
                            "filter.method=riekf", "noise.mug.components.1.frame=object"});
  EXPECT_EQ(file.config.path.frames, 20U);
  EXPECT_EQ(file.config.objects[0].misses.fraction, 0.0);
  const SlamJob job = job_from(format_simulation(file, simulate(file.config, 1), 1));
  EXPECT_TRUE(job.method.starts_with("riekf")) << job.method;
}

TEST(SimulationConfig, DemoIsValid) {
  const std::filesystem::path path =
      std::filesystem::path(POSEMIX_SOURCE_DIR) / "configs/demo.toml";
  const SimulationFile file = read_simulation(TomlDocument::load(path));
  EXPECT_EQ(file.config.path.frames, 600U);
  EXPECT_EQ(file.config.objects.size(), 5U);
}

TEST(SimulationConfig, ErrorsNameFileLineAndKey) {
  const auto message = [](const std::string& from, const std::string& to) {
    return testing::invalid_input_message([&] { config_from(with(from, to)); });
  };
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& part) {
    const std::string text = message(from, to);
    EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks: " << part;
  };
  expect("turns = 1", "turn = 1", "sim.toml:6: unknown key 'camera.turn'");
  expect("frames = 40", "frames = 0", "sim.toml:4: key 'camera.frames'");
  expect("schema = 1", "schema = 2", "sim.toml:1: key 'schema'");
  expect("period_s = 0.04", "period_s = 0", "sim.toml:5: key 'camera.period_s'");
  expect("period_s = 0.04", "period_ms = 40", "sim.toml:5: ");
  expect("rotation_sd_deg = 0.2", "rotation_sd_deg = -0.2",
         "sim.toml:14: key 'odometry.rotation_sd");
  expect("rotation_sd_deg = 0.2", "rotation_sd_rad = 0.2", "sim.toml:14: ");
  expect("translation_sd_m = 0.01}", "translation_sd_m = -1}", "sim.toml:23: key 'noise.plain");
  expect("weight = 3", "weight = 0", "sim.toml:19: key 'noise.mug.components[0].weight'");
  expect("noise = \"plain\"", "noise = \"plane\"", "sim.toml:37: key 'objects[1].noise'");
  expect("misses = {fraction = 0.2}", "misses = {fraction = 1.2}",
         "sim.toml:33: key 'objects[0].misses.fraction'");
  expect("fraction = 0.1", "fraction = -0.1", "sim.toml:32: key 'objects[0].outliers.fraction'");
  expect("id = \"box.2\"", "id = \"mug\"", "sim.toml:36: key 'objects[1].id'");
  expect("id = \"box.2\"", "id = \"a b\"", "sim.toml:36: key 'objects[1].id'");
  expect("hidden_frames = 15", "hidden_frames = 40", "sim.toml:39: key 'objects[1].hidden_frames'");
  expect("\"runnalls\"", "\"runnals\"", "sim.toml:45: key 'filter.pair_rule'");
  expect("mean_m = 0.3", "mean_m = 0.8", "sim.toml: simulation: path: the smallest range");
}

}  // namespace
}  // namespace posemix
