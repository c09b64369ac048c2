// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The baselines of the key filter.method of a sequence file.
#include <cmath>

#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/text.hpp"
#include "posemix/testing/expect.hpp"
#include "small_recording.hpp"

namespace posemix {
namespace {

using testing::thrown_message;

SlamJob read_small(const std::vector<std::string>& overrides) {
  const testing::SmallFolder small;
  TomlDocument document = TomlDocument::parse(testing::kSmallToml, "s.toml");
  for (const std::string& each : overrides) document.apply_override(each);
  return read_slam_job(document, {small.folder.path()});
}

GaussianSumSettings gaussian_sum(const SlamJob& job) {
  return std::get<GaussianSumSettings>(job.settings.tracker);
}

TEST(FilterMethods, EveryMethodOfTheLibraryByName) {
  for (const SlamMethod& method : slam_methods()) {
    const SlamJob job = read_small({"filter={method='" + method.name + "'}"});
    EXPECT_EQ(job.method, method.title());
    EXPECT_EQ(job.settings.tracker.index(), method.tracker.index());
    EXPECT_EQ(job.smoothing.has_value(), method.smoothing.has_value());
  }
  const GaussianSumSettings midway = gaussian_sum(read_small({"filter={method='midway'}"}));
  EXPECT_EQ(midway.noise_use, NoiseUse::joint);
  EXPECT_EQ(midway.reduction.max_components, 12U);
  // A key changes a setting of the method, but for those that make it.
  EXPECT_EQ(gaussian_sum(read_small({"filter={method='midway', max_components=5}"}))
                .reduction.max_components,
            5U);
  EXPECT_EQ(gaussian_sum(read_small({"filter={method='riekf', max_components=5}"}))
                .reduction.max_components,
            1U);
  EXPECT_INVALID_WITH(read_small({"filter.method=ekf"}), "key 'filter.method'");
}

TEST(FilterMethods, BaselinesByName) {
  const SlamJob cauchy = read_small({"filter.method=riekf_cauchy", "filter.cauchy_scale=2"});
  EXPECT_EQ(cauchy.method, "riekf (Cauchy, c = 2, gate 0.9999)");
  EXPECT_EQ(gaussian_sum(cauchy).robust_loss, RobustLoss::cauchy);
  EXPECT_EQ(gaussian_sum(cauchy).cauchy_scale, 2.0);
  EXPECT_EQ(gaussian_sum(cauchy).reduction.max_components, 1U);
  EXPECT_EQ(cauchy.models[0].noise.components().size(), 1U);
  EXPECT_EQ(gaussian_sum(read_small({"filter.robust_loss=cauchy"})).robust_loss,
            RobustLoss::cauchy);
  const SlamJob max_mixture = read_small({"filter.method=max_mixture"});
  EXPECT_EQ(max_mixture.method, "max-mixture");
  EXPECT_EQ(gaussian_sum(max_mixture).noise_use, NoiseUse::most_likely);
  EXPECT_EQ(gaussian_sum(max_mixture).update, UpdateRule::linearized);
  EXPECT_EQ(gaussian_sum(max_mixture).reduction.max_components, 1U);
  const SlamJob plain = read_small({});
  EXPECT_EQ(max_mixture.models[2].noise.components().size(),
            plain.models[2].noise.components().size());
  EXPECT_INVALID_WITH(read_small({"filter.cauchy_scale=0"}), "key 'filter.cauchy_scale'");
}

TEST(FilterMethods, ParticleFilter) {
  const SlamJob job =
      read_small({"filter.method=rbpf", "filter.particles=50", "filter.particle_seed=7",
                  "filter.resample_below=0.25", "filter.particle_walk_rotation_sd_deg=2",
                  "filter.particle_walk_translation_sd_m=[0.1, 0.2, 0.3]",
                  "filter.particle_kernel_rotation_sd_deg=3", "filter.particle_hypotheses=32"});
  EXPECT_EQ(job.method, "rbpf (50 particles)");
  const auto* particles = std::get_if<ParticleFilterSettings>(&job.settings.tracker);
  ASSERT_NE(particles, nullptr);
  EXPECT_EQ(particles->particles, 50U);
  EXPECT_EQ(particles->seed, 7U);
  EXPECT_EQ(particles->resample_below, 0.25);
  const Matrix6d walk = particles->object_walk.covariance;
  EXPECT_NEAR(std::sqrt(walk(1, 1)), radians(2.0), 1e-15);
  EXPECT_NEAR(std::sqrt(walk(5, 5)), 0.3, 1e-15);
  const ParticleFilterSettings defaults;
  EXPECT_NEAR(std::sqrt(particles->kernel(2, 2)), radians(3.0), 1e-15);
  EXPECT_NEAR(particles->kernel(4, 4), defaults.kernel(4, 4), 1e-20);
  EXPECT_EQ(particles->hypotheses, 32U);
  const SlamJob plain = read_small({"filter.method=rbpf"});
  EXPECT_EQ(std::get<ParticleFilterSettings>(plain.settings.tracker).kernel, defaults.kernel);
  // `run` of the job is the particle filter.
  const SlamRun by_job = run(job);
  const SlamRun direct = run(job.sequence, job.camera_prior, job.models,
                             {.motion = job.settings.motion, .tracker = *particles});
  EXPECT_EQ(by_job.posterior.size(), 32U);
  EXPECT_EQ(by_job.frames.back().camera.mean().matrix(),
            direct.frames.back().camera.mean().matrix());
  EXPECT_INVALID_WITH(read_small({"filter.particles=0"}), "key 'filter.particles'");
  EXPECT_INVALID_WITH(
      read_small({"filter.method=rbpf", "filter.particle_kernel_translation_sd_m=0"}),
      "key 'filter.particle_kernel_translation_sd_m'");
}

/// Runs the multi-object filter on the small recording.
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
  // The job smooths.
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

TEST(FilterMethods, AnUnknownKeyListsNoneThatTheMethodRefuses) {
  for (const SlamMethod& method : slam_methods()) {
    const std::string of_method = "filter={method='" + method.name + "'";
    const std::string message =
        thrown_message([&] { read_small({of_method + ", unheard_of_altogether=1}"}); });
    const std::size_t list = message.find(", known here: ");
    ASSERT_NE(list, std::string::npos) << message;
    const std::string known = message.substr(list + 14);
    for (const std::string_view key : split_fields(known, ',')) {
      // An array is a wrong value of every key but not an unknown one.
      const std::string refusal = thrown_message(
          [&] { read_small({of_method + ", " + std::string(trimmed(key)) + "=[[]]}"}); });
      EXPECT_EQ(refusal.find("is for"), std::string::npos) << method.name << ": " << refusal;
      EXPECT_EQ(refusal.find("unknown key"), std::string::npos) << method.name << ": " << refusal;
    }
  }
}

TEST(FilterMethods, AssociationOfCandidates) {
  const SlamJob job = read_multi_object_job(
      {"association.gate_probability=0.9", "association.rotation_cap_probability=0.8",
       "association.least_new_score=-0.5", "association.least_separation_m=0.1",
       "association.confirming_detections=5", "association.certain_probability=0.7",
       "association.joint_assignments=9"});
  const auto settings = std::get<MultiObjectSlamSettings>(job.settings.tracker);
  EXPECT_EQ(settings.association.gate_probability, 0.9);
  EXPECT_EQ(settings.association.rotation_cap_probability, 0.8);
  EXPECT_EQ(settings.association.least_new_score, -0.5);
  EXPECT_EQ(settings.association.least_separation_m, 0.1);
  EXPECT_EQ(settings.confirming_detections, 5U);
  EXPECT_EQ(settings.association.certain_probability, 0.7);
  EXPECT_EQ(settings.association.joint_assignments, 9U);
  const MultiObjectSlamSettings defaults;
  const SlamJob plain_job = read_multi_object_job({});
  const auto plain = std::get<MultiObjectSlamSettings>(plain_job.settings.tracker);
  EXPECT_EQ(plain.association.gate_probability, defaults.association.gate_probability);
  EXPECT_EQ(plain.confirming_detections, defaults.confirming_detections);
  EXPECT_INVALID_WITH(read_multi_object_job({"association.gate_probability=1"}),
                      "key 'association.gate_probability'");
  EXPECT_INVALID_WITH(read_multi_object_job({"association.confirming_detections=-1"}),
                      "key 'association.confirming_detections'");
  EXPECT_INVALID_WITH(read_multi_object_job({"association.joint_assignments=0"}),
                      "key 'association.joint_assignments'");
  EXPECT_INVALID_WITH(read_small({"filter.method=gm-iekf", "association.least_new_score=1"}),
                      "association");
}

TEST(FilterMethods, ExistenceOfObjects) {
  const SlamJob job = read_multi_object_job(
      {"filter.existence={birth_probability=0.1, object_rate=[3, 2], clutter_rate=[1, 9], "
       "visible_time_s=1, hidden_time_s=2, lifetime_s=3, look_time_s=0, exclusion_m=0.1, "
       "confirmed_probability=0.8, deleted_probability=0}"});
  const auto s = std::get<MultiObjectSlamSettings>(job.settings.tracker).existence;
  EXPECT_EQ(s.birth_probability, 0.1);
  EXPECT_EQ(s.object_rate.a, 3.0);
  EXPECT_EQ(s.object_rate.b, 2.0);
  EXPECT_EQ(s.clutter_rate.b, 9.0);
  EXPECT_EQ(s.visible_time_s, 1.0);
  EXPECT_EQ(s.hidden_time_s, 2.0);
  EXPECT_EQ(s.lifetime_s, 3.0);
  EXPECT_EQ(s.look_time_s, 0.0);
  EXPECT_EQ(s.exclusion_m, 0.1);
  EXPECT_EQ(s.confirmed_probability, 0.8);
  EXPECT_EQ(s.deleted_probability, 0.0);
  const auto refused = [](const std::string& what) {
    return thrown_message([&] { read_multi_object_job({"filter.existence={" + what + "}"}); });
  };
  for (const char* wrong :
       {"birth_probability=0", "object_rate=[1]", "object_rate=2", "clutter_rate=[1, 0]",
        "visible_time_s=0", "hidden_time_s=-1", "lifetime_s=0", "look_time_s=-1", "exclusion_m=-1",
        "confirmed_probability=1", "deleted_probability=0.95", "deleted_probability=inf"}) {
    const std::string key = std::string(wrong).substr(0, std::string(wrong).find('='));
    EXPECT_NE(refused(wrong).find("'filter.existence." + key), std::string::npos)
        << wrong << ": " << refused(wrong);
  }
  EXPECT_NE(refused("lifetime=1").find("lifetime_s"), std::string::npos);
  EXPECT_NE(thrown_message([] {
              read_small({"filter.method=gm-iekf", "filter.existence={}"});
            }),
            "");
}

TEST(FilterMethods, HealthOfTracks) {
  const SlamJob job = read_multi_object_job(
      {"filter.health={mode_probability=0.5, window_detections=4, band_probability=0.99, "
       "lost_probability=0.2, register_again_s=7}"});
  const auto s = std::get<MultiObjectSlamSettings>(job.settings.tracker).health;
  EXPECT_EQ(s.mode_probability, 0.5);
  EXPECT_EQ(s.window_detections, 4.0);
  EXPECT_EQ(s.band_probability, 0.99);
  EXPECT_EQ(s.lost_probability, 0.2);
  EXPECT_EQ(s.register_again_s, 7.0);
  for (const std::string wrong : {"mode_probability=2", "window_detections=0", "band_probability=1",
                                  "lost_probability=-1", "register_again_s=-1"}) {
    EXPECT_INVALID_WITH(read_multi_object_job({"filter.health={" + wrong + "}"}),
                        "key 'filter.health." + wrong.substr(0, wrong.find('=')) + "'");
  }
}

}  // namespace
}  // namespace posemix
