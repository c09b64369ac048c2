// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/text.hpp"
#include "posemix/results/results.hpp"

/// The defaults in docs/formats.md equal the defaults of the settings.
namespace posemix {
namespace {

/// The last cell of the first table row after the text `from` that begins with the key.
std::string documented(const std::string& key, const std::string& from = "") {
  const std::string text = read_file(POSEMIX_SOURCE_DIR "/docs/formats.md");
  const std::size_t row = text.find("\n| `" + key + "`", text.find(from));
  if (row == std::string::npos) return "(no row of " + key + ")";
  const std::size_t end = text.find(" |\n", row);
  const std::size_t cell = text.rfind("| ", end - 1);
  return text.substr(cell + 2, end - cell - 2);
}

TEST(FormatsDocument, DefaultsOfTheFilter) {
  const GaussianSumSettings s;
  EXPECT_EQ(documented("update", "### `[filter]`"),
            s.update == UpdateRule::iterated ? "iterated" : "linearized");
  EXPECT_EQ(documented("noise_use"), s.noise_use == NoiseUse::per_object ? "per_object" : "joint");
  EXPECT_EQ(documented("gate_probability", "### `[filter]`"),
            fmt::format("{:g}", s.gate_probability));
  EXPECT_EQ(documented("summary"), s.summary == Summary::whole_mixture ? "whole_mixture" : "other");
  EXPECT_EQ(documented("max_components"), fmt::format("{}", s.reduction.max_components));
  EXPECT_EQ(documented("merge_from"), fmt::format("{}", s.reduction.merge_from));
  EXPECT_EQ(parse_number(documented("prune_below")), s.reduction.prune_below);
  EXPECT_EQ(documented("drop_smallest"), fmt::format("{}", s.reduction.drop_smallest));
  EXPECT_EQ(documented("keep_heaviest"), fmt::format("{}", s.reduction.keep_heaviest));
  EXPECT_EQ(documented("merge_rule"),
            s.reduction.merge.rule == MergeRule::midway ? "midway" : "other");
  EXPECT_EQ(documented("pair_rule"), s.reduction.pair == PairRule::largest_with_smallest
                                         ? "largest_with_smallest"
                                         : "other");
  EXPECT_EQ(documented("distance"),
            s.reduction.distance == DistanceMetric::tangent_norm ? "tangent_norm" : "other");
  EXPECT_EQ(documented("transport_jacobian"),
            s.reduction.merge.jacobian == TransportJacobian::exact ? "exact" : "bernoulli");
  EXPECT_EQ(documented("trace_hypotheses"), fmt::format("{}", kTraceHypotheses));
  EXPECT_EQ(documented("cauchy_scale"), fmt::format("{:g}", s.cauchy_scale));
}

TEST(FormatsDocument, DefaultsOfTheAssociation) {
  const MultiObjectSlamSettings s;
  const std::string from = "table `[association]`";
  EXPECT_EQ(documented("gate_probability", from),
            fmt::format("{:g}", s.association.gate_probability));
  EXPECT_EQ(documented("rotation_cap_probability"),
            fmt::format("{:g}", s.association.rotation_cap_probability));
  EXPECT_EQ(documented("least_new_score"), fmt::format("{:g}", s.association.least_new_score));
  EXPECT_EQ(documented("least_separation_m"),
            fmt::format("{:g}", s.association.least_separation_m));
  EXPECT_EQ(documented("certain_probability", from),
            fmt::format("{:g}", s.association.certain_probability));
  EXPECT_EQ(documented("joint_assignments", from),
            fmt::format("{}", s.association.joint_assignments));
  EXPECT_EQ(documented("confirming_detections"), fmt::format("{}", s.confirming_detections));
}

TEST(FormatsDocument, DefaultsOfSmoothing) {
  EXPECT_EQ(documented("smooth"), "none");
  EXPECT_EQ(documented("smooth_lag"), fmt::format("{}", kSmoothLag));
  EXPECT_EQ(documented("smooth_passes"), fmt::format("{}", SmoothingSettings().passes));
  EXPECT_EQ(documented("smooth_least_probability"),
            fmt::format("{:g}", SmoothingSettings().least_probability));
}

TEST(FormatsDocument, DefaultsOfTheParticleFilter) {
  const ParticleFilterSettings s;
  EXPECT_EQ(documented("particles"), fmt::format("{}", s.particles));
  EXPECT_EQ(documented("particle_seed"), fmt::format("{}", s.seed));
  EXPECT_EQ(documented("resample_below"), fmt::format("{:g}", s.resample_below));
  const Vector6d sd = s.object_walk.covariance.diagonal().cwiseSqrt();
  EXPECT_EQ(documented("particle_walk_rotation_sd_deg`, `particle_walk_translation_sd_m"),
            fmt::format("{:g}, {:g}", degrees(sd[0]), sd[3]));
  const Vector6d kernel = s.kernel.diagonal().cwiseSqrt();
  EXPECT_EQ(documented("particle_kernel_rotation_sd_deg`, `particle_kernel_translation_sd_m"),
            fmt::format("{:g}, {:g}", degrees(kernel[0]), kernel[3]));
  EXPECT_EQ(documented("particle_hypotheses"), fmt::format("{}", s.hypotheses));
}

std::string noise(const ProcessNoise& noise) {
  const Vector6d sd = noise.covariance.diagonal().cwiseSqrt();
  return fmt::format("per {}, {:.4g} deg, {:.4g} m",
                     noise.per == NoisePer::second ? "second" : "frame", degrees(sd[0]), sd[3]);
}

TEST(FormatsDocument, DefaultsOfTheMultiObjectFilter) {
  const MultiObjectSettings s;
  const auto number = [](double value) { return fmt::format("{:g}", value); };
  EXPECT_EQ(documented("max_hypotheses"), fmt::format("{}", s.max_hypotheses));
  EXPECT_EQ(documented("protected_hypotheses"), fmt::format("{}", s.protected_hypotheses));
  EXPECT_EQ(documented("explained_probability"), number(s.explained_probability));
  EXPECT_EQ(documented("default_clutter"), number(s.default_clutter));
  EXPECT_EQ(documented("birth_score`, `score_memory"),
            number(s.birth_score) + ", " + number(s.score_memory));
  EXPECT_EQ(documented("merge_rotation_deg`, `merge_translation_m`, `merge_probability"),
            fmt::format("{:g}, {:g}, {:g}", degrees(s.merge_rotation_rad), s.merge_translation_m,
                        s.merge_probability));
  EXPECT_EQ(documented("leader_margin"), number(s.leader_margin));
  EXPECT_EQ(documented("split_loss`, `max_global_hypotheses"),
            fmt::format("{:g}, {}", s.split_loss, s.max_global_hypotheses));
  EXPECT_EQ(documented("camera_gain"), number(s.camera_gain));
  EXPECT_EQ(documented("slow_error_gain"), number(s.slow_error_gain));
  EXPECT_EQ(documented("camera_rotation_correction`, `camera_position_correction"),
            number(s.camera_rotation_correction) + ", " + number(s.camera_position_correction));
  EXPECT_EQ(documented("noise_scale_detections`, `least_noise_scale"),
            number(s.noise_scale_detections) + ", " + number(s.least_noise_scale));
}

TEST(FormatsDocument, DefaultsOfExistenceAndHealth) {
  const std::string from = "### Objects that come and go";
  const auto is = [&](const std::string& key, double value) {
    EXPECT_EQ(documented(key, from), fmt::format("{:g}", value)) << key;
  };
  const ExistenceSettings e;
  is("birth_probability", e.birth_probability);
  EXPECT_EQ(documented("object_rate`, `clutter_rate", from),
            fmt::format("[{:g}, {:g}], [{:g}, {:g}]", e.object_rate.a, e.object_rate.b,
                        e.clutter_rate.a, e.clutter_rate.b));
  EXPECT_EQ(documented("visible_time_s`, `hidden_time_s", from),
            fmt::format("{:g}, {:g}", e.visible_time_s, e.hidden_time_s));
  is("lifetime_s", e.lifetime_s);
  is("look_time_s", e.look_time_s);
  is("exclusion_m", e.exclusion_m);
  is("confirmed_probability", e.confirmed_probability);
  is("deleted_probability", e.deleted_probability);
  const HealthSettings h;
  is("mode_probability", h.mode_probability);
  is("window_detections", h.window_detections);
  EXPECT_EQ(documented("band_probability", from), fmt::format("{}", h.band_probability));
  is("lost_probability", h.lost_probability);
  is("register_again_s", h.register_again_s);
}

TEST(FormatsDocument, DefaultsOfTheMotion) {
  const MotionSettings s;
  EXPECT_EQ(documented("period_s"), fmt::format("{:g}", s.period_s));
  const ProcessNoise at_scene{at_camera(s.noise.covariance, -kDefaultSceneDistance)};
  EXPECT_EQ(documented("noise", "### `[motion]`"),
            fmt::format("{}, at {:g} m", noise(at_scene), kDefaultSceneDistance));
  EXPECT_LT((at_scene.covariance - Matrix6d(at_scene.covariance.diagonal().asDiagonal())).norm(),
            1e-20);
  EXPECT_EQ(documented("noise", "of the odometry, of a given pose"), noise(s.walk));
  EXPECT_EQ(documented("motion_noise"), noise(s.motion_noise));
  EXPECT_EQ(documented("unknown_motion"), noise(s.unknown_motion));
  EXPECT_EQ(documented("frame_period_s"), fmt::format("{:g}", kFramePeriodS));
  EXPECT_EQ(documented("start.rotation_sd_deg`, `start.translation_sd_m"),
            fmt::format("{:g}, {:g}", kStartRotationSdDeg, kStartTranslationSdM));
}

}  // namespace
}  // namespace posemix
