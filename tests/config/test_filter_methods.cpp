// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The baselines of the key filter.method of a sequence file.
#include <cmath>

#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/sequence_file.hpp"
#include "small_recording.hpp"

namespace posemix {
namespace {

SlamJob read_small(const std::vector<std::string>& overrides) {
  const testing::SmallFolder small;
  TomlDocument document = TomlDocument::parse(testing::kSmallToml, "s.toml");
  for (const std::string& each : overrides) document.apply_override(each);
  return read_slam_job(document, {small.folder.path()});
}

TEST(FilterMethods, BaselinesByName) {
  const SlamJob cauchy = read_small({"filter.method=riekf_cauchy", "filter.cauchy_scale=2"});
  EXPECT_EQ(cauchy.method, "riekf (Cauchy, c = 2)");
  EXPECT_EQ(cauchy.settings.filter.robust_loss, RobustLoss::cauchy);
  EXPECT_EQ(cauchy.settings.filter.cauchy_scale, 2.0);
  EXPECT_EQ(cauchy.settings.filter.reduction.max_components, 1U);
  EXPECT_EQ(cauchy.models[0].noise.components().size(), 1U);
  EXPECT_EQ(read_small({"filter.robust_loss=cauchy"}).settings.filter.robust_loss,
            RobustLoss::cauchy);
  const SlamJob max_mixture = read_small({"filter.method=max_mixture"});
  EXPECT_EQ(max_mixture.method, "max-mixture");
  EXPECT_EQ(max_mixture.settings.filter.noise_use, NoiseUse::most_likely);
  EXPECT_EQ(max_mixture.settings.filter.update, UpdateRule::linearized);
  EXPECT_EQ(max_mixture.settings.filter.reduction.max_components, 1U);
  const SlamJob plain = read_small({});
  EXPECT_EQ(max_mixture.models[2].noise.components().size(),
            plain.models[2].noise.components().size());
  EXPECT_FALSE(plain.particles.has_value());
  EXPECT_INVALID_WITH(read_small({"filter.cauchy_scale=0"}), "key 'filter.cauchy_scale'");
}

TEST(FilterMethods, ParticleFilter) {
  const SlamJob job =
      read_small({"filter.method=rbpf", "filter.particles=50", "filter.particle_seed=7",
                  "filter.resample_below=0.25", "filter.particle_walk_rotation_sd_deg=2",
                  "filter.particle_walk_translation_sd_m=[0.1, 0.2, 0.3]",
                  "filter.particle_kernel_rotation_sd_deg=3", "filter.particle_hypotheses=32"});
  EXPECT_EQ(job.method, "rbpf (50 particles)");
  ASSERT_TRUE(job.particles.has_value());
  EXPECT_EQ(job.particles->particles, 50U);
  EXPECT_EQ(job.particles->seed, 7U);
  EXPECT_EQ(job.particles->resample_below, 0.25);
  const Matrix6d walk = job.particles->object_walk.covariance;
  EXPECT_NEAR(std::sqrt(walk(1, 1)), radians(2.0), 1e-15);
  EXPECT_NEAR(std::sqrt(walk(5, 5)), 0.3, 1e-15);
  const ParticleFilterSettings defaults;
  EXPECT_NEAR(std::sqrt(job.particles->kernel(2, 2)), radians(3.0), 1e-15);
  EXPECT_NEAR(job.particles->kernel(4, 4), defaults.kernel(4, 4), 1e-20);
  EXPECT_EQ(job.particles->hypotheses, 32U);
  EXPECT_EQ(read_small({"filter.method=rbpf"}).particles->kernel, defaults.kernel);
  EXPECT_EQ(job.particles->motion.model, job.settings.motion.model);
  EXPECT_EQ(job.particles->motion.noise.covariance, job.settings.motion.noise.covariance);
  // `run` of the job is the particle filter.
  const SlamRun by_job = run(job);
  const SlamRun direct =
      run_particle_filter(job.sequence, job.camera_prior, job.models, *job.particles);
  EXPECT_EQ(by_job.posterior.size(), 32U);
  EXPECT_EQ(by_job.frames.back().camera.mean().matrix(),
            direct.frames.back().camera.mean().matrix());
  EXPECT_INVALID_WITH(read_small({"filter.particles=0"}), "key 'filter.particles'");
  EXPECT_INVALID_WITH(
      read_small({"filter.method=rbpf", "filter.particle_kernel_translation_sd_m=0"}),
      "key 'filter.particle_kernel_translation_sd_m'");
}

/// The small recording by the multi-object filter.
SlamJob read_multi_object_job(const std::vector<std::string>& overrides) {
  const testing::SmallFolder small;
  std::string text(testing::kSmallToml.substr(0, testing::kSmallToml.find("[filter]")));
  TomlDocument document = TomlDocument::parse(text, "s.toml");
  for (const std::string& each : overrides) document.apply_override(each);
  return read_slam_job(document, {small.folder.path()});
}

TEST(FilterMethods, Smoothing) {
  EXPECT_FALSE(read_multi_object_job({}).smoothing.has_value());
  EXPECT_FALSE(read_multi_object_job({"filter.smooth=none"}).smoothing.has_value());
  const SlamJob full = read_multi_object_job({"filter.smooth=full", "filter.smooth_passes=2"});
  EXPECT_EQ(full.method, "multi-object, smoothed");
  ASSERT_TRUE(full.smoothing.has_value());
  EXPECT_EQ(full.smoothing->lag_frames, 0U);
  EXPECT_EQ(full.smoothing->passes, 2U);
  const SlamJob lag = read_multi_object_job({"filter.smooth=fixed_lag"});
  EXPECT_EQ(lag.method, "multi-object, smoothed by 20 frames");
  EXPECT_EQ(lag.smoothing->lag_frames, kSmoothLag);
  EXPECT_EQ(read_multi_object_job({"filter.smooth=fixed_lag", "filter.smooth_lag=7"})
                .smoothing->lag_frames,
            7U);
  const SlamJob likely =
      read_multi_object_job({"filter.smooth=full", "filter.smooth_least_probability=0.25"});
  EXPECT_EQ(likely.smoothing->least_probability, 0.25);
  // `run` of the job smooths.
  const SlamRun by_job = run(full);
  const SlamRun direct =
      run_smoothed(full.sequence, full.camera_prior, full.models, full.settings, {.passes = 2});
  EXPECT_EQ(by_job.frames[3].camera.mean().matrix(), direct.frames[3].camera.mean().matrix());
  EXPECT_NE(by_job.frames[3].camera.mean().matrix(),
            run(read_multi_object_job({})).frames[3].camera.mean().matrix());
  EXPECT_INVALID_WITH(read_multi_object_job({"filter.smooth=half"}), "key 'filter.smooth'");
  EXPECT_INVALID_WITH(read_multi_object_job({"filter.smooth=fixed_lag", "filter.smooth_lag=0"}),
                      "key 'filter.smooth_lag'");
  for (const std::string method : {"gm-iekf", "riekf", "rbpf"})
    EXPECT_INVALID_WITH(read_small({"filter.method=" + method, "filter.smooth=full"}),
                        "key 'filter.smooth' is for filter.method = \"multi_object\"");
}

TEST(FilterMethods, AssociationOfCandidates) {
  const SlamJob job = read_multi_object_job(
      {"association.gate_probability=0.9", "association.rotation_cap_probability=0.8",
       "association.least_new_score=-0.5", "association.least_separation_m=0.1",
       "association.confirming_detections=5"});
  EXPECT_EQ(job.settings.association.gate_probability, 0.9);
  EXPECT_EQ(job.settings.association.rotation_cap_probability, 0.8);
  EXPECT_EQ(job.settings.association.least_new_score, -0.5);
  EXPECT_EQ(job.settings.association.least_separation_m, 0.1);
  EXPECT_EQ(job.settings.confirming_detections, 5U);
  const ObjectSlamSettings defaults;
  const SlamJob plain = read_multi_object_job({});
  EXPECT_EQ(plain.settings.association.gate_probability, defaults.association.gate_probability);
  EXPECT_EQ(plain.settings.confirming_detections, defaults.confirming_detections);
  EXPECT_INVALID_WITH(read_multi_object_job({"association.gate_probability=1"}),
                      "key 'association.gate_probability'");
  EXPECT_INVALID_WITH(read_multi_object_job({"association.confirming_detections=-1"}),
                      "key 'association.confirming_detections'");
  EXPECT_INVALID_WITH(read_small({"filter.method=gm-iekf", "association.least_new_score=1"}),
                      "association");
}

}  // namespace
}  // namespace posemix
