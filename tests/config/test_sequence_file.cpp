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

class SequenceFile : public testing::SmallSequence {};

TEST_F(SequenceFile, ReadsEverySource) {
  const SlamJob job = read_with({});
  EXPECT_EQ(job.name, "s 0001");
  EXPECT_EQ(job.method, "gm-iekf (midway)");
  const Sequence& sequence = job.sequence;
  ASSERT_EQ(sequence.stamps.size(), kSmallFrames);
  ASSERT_EQ(sequence.objects.size(), 3U);
  EXPECT_EQ(sequence.objects[0].id, "mug");
  for (std::size_t k = 0; k < kSmallFrames; ++k) {
    EXPECT_TRUE(sequence.camera_truth[k]->is_approx(small_.recording.camera[k], 1e-10));
    EXPECT_EQ(sequence.objects[0].detections[k].has_value(), k != 3);
    EXPECT_TRUE(
        sequence.objects[1].detections[k]->is_approx(small_.recording.detections[1][k], 1e-12));
    EXPECT_EQ(sequence.objects[2].detections[k].has_value(), k % 2 == 0);
    if (k % 2 == 0) {
      EXPECT_TRUE(
          sequence.objects[2].detections[k]->is_approx(small_.recording.detections[2][k], 1e-9));
    }
    EXPECT_TRUE(sequence.objects[0].relative_truth[k].has_value());
    EXPECT_TRUE(sequence.objects[1].world_truth[k]->is_approx(small_.recording.objects[1], 1e-10));
    EXPECT_TRUE(sequence.objects[2].world_truth[k]->is_approx(small_.recording.objects[2], 1e-12));
  }
}

TEST_F(SequenceFile, SettingsArriveWithTheirUnits) {
  const SlamJob job = read_with({});
  EXPECT_NEAR(job.camera_prior.covariance()(0, 0), std::pow(radians(0.1), 2), 1e-18);
  EXPECT_NEAR(job.camera_prior.covariance()(5, 5), 4e-6, 1e-18);
  EXPECT_TRUE(job.camera_prior.mean().is_approx(small_.recording.camera[0], 1e-10));
  const auto& components = job.models[0].noise.components();
  ASSERT_EQ(components.size(), 2U);
  EXPECT_NEAR(components[1].covariance(2, 2), std::pow(radians(9.0), 2), 1e-15);
  EXPECT_NEAR(components[1].covariance(3, 3), 25e-6, 1e-15);
  EXPECT_EQ(job.settings.motion.model, MotionModel::odometry);
  EXPECT_EQ(job.settings.motion.noise.per, NoisePer::second);
  EXPECT_NEAR(job.settings.motion.noise.covariance(0, 0), std::pow(radians(0.15), 2), 1e-18);
  const auto& filter = std::get<GaussianSumSettings>(job.settings.tracker);
  EXPECT_EQ(filter.reduction.max_components, 4U);
  EXPECT_EQ(filter.gate_probability, 0.9999);
}

TEST_F(SequenceFile, DefaultsAreThoseOfTheSettings) {
  const std::string filter =
      "[filter]\nmethod = \"gm-iekf\"\nmax_components = 4\ngate_probability = 0.9999\nupdate = "
      "\"linearized\"\n";
  const std::string text = replaced(std::string(kSmallToml), filter, "");
  const SlamJob sum = read(text + "[filter]\nmethod = \"gm-iekf\"\n");
  const auto& read_filter = std::get<GaussianSumSettings>(sum.settings.tracker);
  const GaussianSumSettings filter_defaults;
  EXPECT_EQ(read_filter.reduction.max_components, filter_defaults.reduction.max_components);
  EXPECT_EQ(read_filter.reduction.prune_below, filter_defaults.reduction.prune_below);
  EXPECT_EQ(read_filter.gate_probability, filter_defaults.gate_probability);
  EXPECT_EQ(read_filter.update, filter_defaults.update);
  EXPECT_EQ(read_filter.summary, filter_defaults.summary);
  const SlamJob job = read(text);
  const ObjectSlamSettings defaults;
  EXPECT_EQ(std::get<MultiObjectSlamSettings>(job.settings.tracker).filter.max_hypotheses,
            MultiObjectSettings().max_hypotheses);
  EXPECT_EQ(job.settings.motion.period_s, defaults.motion.period_s);
  EXPECT_EQ(job.settings.motion.unknown_motion.covariance,
            defaults.motion.unknown_motion.covariance);
  EXPECT_EQ(job.trace_hypotheses, kTraceHypotheses);
}

TEST_F(SequenceFile, EverySettingCanBeSet) {
  const SlamJob job =
      read_with({"motion.model=constant_velocity", "motion.period_s=0.2", "motion.noise.per=frame",
                 "motion.motion_noise={rotation_sd_deg=2, translation_sd_m=[1,2,3]}",
                 "motion.unknown_motion={rotation_sd_deg=0, translation_sd_m=0}",
                 "filter.noise_use=joint", "filter.update=iterated", "filter.summary=best",
                 "filter.merge_from=8", "filter.drop_smallest=2", "filter.keep_heaviest=64",
                 "filter.prune_below=0", "filter.merge_rule=moment_matched",
                 "filter.pair_rule=runnalls", "filter.distance=mahalanobis",
                 "filter.transport_jacobian=bernoulli", "output.trace_hypotheses=3"});
  const ObjectSlamSettings& s = job.settings;
  EXPECT_EQ(s.motion.model, MotionModel::constant_velocity);
  EXPECT_EQ(s.motion.period_s, 0.2);
  EXPECT_EQ(s.motion.noise.per, NoisePer::frame);
  EXPECT_EQ(s.motion.motion_noise.covariance(5, 5), 9.0);
  EXPECT_TRUE(s.motion.unknown_motion.covariance.isZero());
  const auto& filter = std::get<GaussianSumSettings>(s.tracker);
  EXPECT_EQ(filter.noise_use, NoiseUse::joint);
  EXPECT_EQ(filter.update, UpdateRule::iterated);
  EXPECT_EQ(filter.summary, Summary::best);
  EXPECT_EQ(filter.reduction.merge_from, 8U);
  EXPECT_EQ(filter.reduction.drop_smallest, 2U);
  EXPECT_EQ(filter.reduction.keep_heaviest, 64U);
  EXPECT_EQ(filter.reduction.prune_below, 0.0);
  EXPECT_EQ(filter.reduction.merge.rule, MergeRule::moment_matched);
  EXPECT_EQ(filter.reduction.pair, PairRule::runnalls);
  EXPECT_EQ(filter.reduction.distance, DistanceMetric::mahalanobis);
  EXPECT_EQ(filter.reduction.merge.jacobian, TransportJacobian::bernoulli);
  EXPECT_EQ(job.trace_hypotheses, 3U);
  EXPECT_EQ(job.method, "gm-iekf (moment matched, iterated)");
}

TEST_F(SequenceFile, RiekfHasOneHypothesisAndOneNoiseComponent) {
  const SlamJob job = read_with({"filter.method=riekf"});
  EXPECT_EQ(job.method, "riekf (gate 0.9999)");
  EXPECT_EQ(std::get<GaussianSumSettings>(job.settings.tracker).reduction.max_components, 1U);
  for (const ObjectModel& model : job.models) EXPECT_EQ(model.noise.components().size(), 1U);
}

TEST_F(SequenceFile, NoiseOffsetsAndFrames) {
  const SlamJob job = read_changed(
      "{weight = 0.3, rotation_sd_deg = [3, 3, 9], translation_sd_m = 0.005}",
      "{weight = 0.3, frame = \"camera\", rotation_sd_deg = 3, translation_sd_m = 0.005, "
      "offset = {rotation_deg = [0, 0, 180], translation_m = [0, 0, 0.1]}}");
  const NoiseComponent& component = job.models[2].noise.components()[1];
  EXPECT_EQ(component.frame, NoiseFrame::camera);
  EXPECT_TRUE(
      component.offset.is_approx(SE3d(SO3d::exp({0, 0, radians(180)}), {0, 0, 0.1}), 1e-12));
}

TEST_F(SequenceFile, WrongKeysAndUnits) {
  EXPECT_INVALID(read_changed("max_components", "max_component"),
                 "s.toml:42: unknown key 'filter.max_component', did you mean 'max_components'?");
  EXPECT_INVALID(
      read_changed("translation_sd_m = 0.002\n\n[motion]", "translation_sd_mm = 2\n\n[motion]"),
      "s.toml:11: key 'camera.start.translation_sd_mm': expected 'translation_sd_m' (metres)");
  EXPECT_INVALID(read_changed("rotation_sd_deg = 3,", "rotation_sd_rad = 0.05,"),
                 "s.toml:18: key 'noise.detector.components[0].rotation_sd_rad': expected "
                 "'rotation_sd_deg' (degrees)");
  EXPECT_INVALID_WITH(read_with({"filter.gate_probability=99"}),
                      "is 99, expected a number in (0, 1]");
  EXPECT_INVALID_WITH(read_with({"filter.merge_rule=middle"}), "expected one of \"midway\"");
  EXPECT_INVALID_WITH(read_with({"motion.noise.rotation_sd_deg=-1"}),
                      "expected a number in [0, 1000000]");
  EXPECT_INVALID_WITH(read_with({"noise.detector.components.0.weight=0"}),
                      "key 'noise.detector.components[0].weight'");
  EXPECT_INVALID_WITH(read_with({"objects.mug.noise=lens"}),
                      "is \"lens\", but there is no table [noise.lens]");
  EXPECT_INVALID_WITH(read_with({"schema=2"}), "this is another version of the sequence file");
  EXPECT_INVALID_WITH(read_changed("schema = 1\n", ""), "key 'schema' is missing");
}

TEST_F(SequenceFile, ObjectIds) {
  EXPECT_INVALID_WITH(read_with({"objects.0.id='a/b'"}), "expected 1 to 100 letters, digits");
  EXPECT_INVALID_WITH(read_with({"objects.0.id=''"}), "expected 1 to 100 letters, digits");
  EXPECT_INVALID_WITH(read_with({"objects.0.id=box"}),
                      "is \"box\", which another object has already");
}

TEST_F(SequenceFile, JointNoiseNeedsEqualWeights) {
  const std::string other = "noise.other={components=[{rotation_sd_deg=3, translation_sd_m=0.01}]}";
  EXPECT_INVALID_WITH(read_with({other, "objects.can.noise=other", "filter.noise_use=joint"}),
                      "key 'filter.noise_use' is \"joint\", which needs noise models with equal "
                      "weights, but those of objects 'mug' and 'can' differ");
  // A key that the file does not have is not named.
  EXPECT_INVALID_WITH(read_with({other, "objects.can.noise=other", "filter={method='midway'}"}),
                      "key 'filter.method' has noise_use = \"joint\", which needs");
  const SlamJob riekf = read_with(
      {other, "objects.can.noise=other", "filter.noise_use=joint", "filter.method=riekf"});
  EXPECT_EQ(riekf.method, "riekf (gate 0.9999)");
}

}  // namespace
}  // namespace posemix
